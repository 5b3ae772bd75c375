"""A fit as tables for people, from the same record as the JSON."""

from collections.abc import Iterator
from typing import Any

from rich.console import Console
from rich.table import Table

from ..report.console_tables import titled_table

THESIS = "the thesis on hierarchical levels of detail reports 4.39 % ± 15.19 % without feedback"

_CANDIDATES = 5  # shown


def print_fit(record: dict[str, Any], console: Console) -> None:
    """Print coefficients, noise, diagnostics, checks and errors."""
    for line in _log_lines(record):
        console.print(line, markup=False)
    console.print(_coefficients(record))
    for line in (*_notes(record), *_sampling(record)):
        console.print(line, markup=False)
    held = [record["heldout"], record["heldout_logs"], *record["transfer"]]
    if any(held):
        console.print(_errors(record))
        for item in filter(None, held):
            if item["reason"]:
                console.print(f"  {item['split']}: {item['reason']}", markup=False)
        console.print(f"  {THESIS}", markup=False)
    if record["unfit"]:
        console.print(f"not to be used for other frames: {record['unfit']}", markup=False)
    if record["cpu"]:
        console.print()
        print_fit(record["cpu"], console)
    elif record["cpu_note"]:
        console.print(record["cpu_note"], markup=False)


def _log_lines(record: dict[str, Any]) -> Iterator[str]:
    for log in record["logs"]:
        notes = "; ".join(log["notes"])
        yield f"{log['name']}: {log['format']}, {log['rows']} frames used; {notes}"
        for warning in log["warnings"]:
            yield f"beware: {warning}"
    reasons = "; ".join(f"{count} {why}" for why, count in record["rejected"].items())
    yield f"left out: {record['rows_rejected']} frames{f' ({reasons})' if reasons else ''}"
    if record["rows_worth"] < record["rows"]:
        yield (
            f"successive frames err alike: {record['rows']} frames are worth "
            f"{record['rows_worth']:.0f} independent ones, and count so"
        )
    for lag, shares in zip(record["lag_frames"], record["lag_explains"], strict=False):
        if shares and (lag or max(shares) > shares[0]):
            listed = ", ".join(f"{share:.0%}" for share in shares)
            yield f"counts of 0 to 6 rows before explain {listed} of the time; lag {lag}"
    for drift in record["drift"]:
        yield (
            f"{drift['log']}: its reference draws moved by {drift['range_pct']:.1f} % (5 to 95 %; "
            f"second half over first {drift['second_half_pct']:+.1f} %); divided out"
        )
    for finding in record["findings"]:
        yield f"beware: {finding}"
    if record["candidates"]:
        yield "terms by held-out log score per frame, smallest set within one standard error:"
        for item in record["candidates"][:_CANDIDATES]:
            behind = f"{item['behind']:.3f} ± {item['behind_se']:.3f} behind the best"
            yield f"  {', '.join(item['terms'])}: {item['log_score']:.4g}, {behind}"


def _coefficients(record: dict[str, Any]) -> Table:
    title = f"{record['target']} = {' + '.join(['base', *record['terms']])}"
    columns = ("coefficient", "mean", "sd", "5 %", "50 %", "95 %", "unit", "informed by")
    table = titled_table(title, columns, ("unit",))
    for name, item in record["coefficients"].items():
        numbers = [f"{item[key]:.4g}" for key in ("mean", "sd", "q05", "q50", "q95")]
        table.add_row(name, *numbers, item["unit"], "log" if item["informed"] else "prior")
    for group in record["collinear"]:
        numbers = [f"{group[key]:.4g}" for key in ("mean", "sd", "q05", "q50", "q95")]
        table.add_row(group["combination"], *numbers, group["unit"], "log, together")
    return table


def _notes(record: dict[str, Any]) -> Iterator[str]:
    for group in record["collinear"]:
        yield (
            f"collinear: {', '.join(group['columns'])} (condition index "
            f"{group['condition_index']:.0f}) cannot be told apart; what the log informs is "
            f"{group['combination']}, for as many of each as come together here"
        )
    for name, item in record["coefficients"].items():
        if not item["informed"]:
            yield (
                f"{name}: the log hardly informs it (contraction {item['prior_contraction']:.2f}; "
                f"moves {item['prior_shift_sd']:.2f} sd with the prior's width)"
            )
    noise = record["noise"]
    text = (
        f"noise: {noise['model']}, {noise['relative_scale']:.1%} of {noise['reference_ms']:.4g} ms"
    )
    if "growth" in noise:
        text += f", {noise['growth']['mean']:.0%} of it grows with the mean"
        text += f", {noise['dof']['q50']:.3g} degrees of freedom"
    yield f"{text}; correlation of successive frames {noise['correlation']:.2f}"
    if noise["slow_scale"]:
        yield (
            f"a slow state of the machine, {noise['slow_scale']:.1%}, forgotten in "
            f"{noise['slow_time_s']:.3g} s"
        )
    if noise["spike_share"]:
        yield (
            f"spikes in {noise['spike_share']:.2%} of frames, {noise['spike_scale']:.0%} longer on "
            "average"
        )
    yield from _elsewhere(record)
    yield "priors:"
    yield from (f"  {prior}" for prior in record["priors"])


def _elsewhere(record: dict[str, Any]) -> Iterator[str]:
    """Yield how the machine differs between occasions and scenes, if it is the GPU's time."""
    if record["target"] == "cpu_ms":
        return
    occasions, scenes = record["occasions"], record["between_scenes"]
    assumed = ", assumed" if occasions["assumed"] else ""
    yield (
        f"between occasions of recording (there are {occasions['count']}) all times differ by "
        f"{occasions['log_sd']:.1%}{assumed}"
    )
    if scenes["log_sd"]:
        listed = ", ".join(f"{name} {sd:.0%}" for name, sd in scenes["log_sd"].items())
        assumed = ", assumed" if scenes["assumed"] else ""
        yield f"between scenes (there are {scenes['count']}) costs differ: {listed}{assumed}"


def _sampling(record: dict[str, Any]) -> Iterator[str]:
    item = record["diagnostics"]
    yield (
        f"sampling: {item['steps']} steps of {item['walkers']} walkers, acceptance "
        f"{item['acceptance']:.2f}, autocorrelation time {item['autocorr_time']:.0f} steps "
        f"({item['lengths']:.0f} lengths), effective samples {item['ess']:.0f}, split R-hat "
        f"{item['r_hat']:.3f}; likelihood from {record['likelihood']}; condition number "
        f"{record['condition_number']:.3g}"
    )
    yield "posterior predictive checks (measured, simulated, share of simulated above):"
    for check in record["predictive_checks"]:
        yield (
            f"  {check['statistic']}: {check['measured']:.3g}, {check['simulated']:.3g}, "
            f"{check['p']:.2f}"
        )


def _errors(record: dict[str, Any]) -> Table:
    columns = ("held out", "frames", "mean", "± se", "sd", "5 %", "25 %", "50 %", "75 %", "95 %")
    columns += ("90 % coverage", "log score")
    table = titled_table("error of prediction, % of the measured time", columns)
    held = (record["heldout"], record["heldout_logs"], *record["transfer"])
    for item in filter(None, held):
        table.add_row(
            item["split"],
            str(item["rows"]),
            f"{item['error_pct_mean']:.2f}",
            f"{item['error_pct_mean_se']:.2f}" if item["error_pct_mean_se"] else "",
            f"{item['error_pct_sd']:.2f}",
            *(f"{value:.1f}" for value in item["error_pct_quantiles"]),
            f"{item['coverage_90']:.1%}",
            f"{item['log_score']:.3f}",
        )
    return table
