const dark = matchMedia("(prefers-color-scheme: dark)");
function paint() {
  const color = getComputedStyle(document.documentElement).getPropertyValue("--ink").trim();
  document.querySelectorAll(".plotly-graph-div").forEach(
    (chart) => Plotly.relayout(chart, { "font.color": color }));
}
dark.addEventListener("change", paint);
paint();
