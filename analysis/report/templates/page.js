"use strict";
(() => {
const all = (query, at = document) => [...at.querySelectorAll(query)];
const WIDE = 20000, HIGH = 2000, off = document.getElementById("off");
const names = all(".legend .names button");
const atFirst = names.filter((b) => b.getAttribute("aria-pressed") === "false").map((b) => b.dataset.p);
let hidden = new Set(atFirst), hot = null, sorted = {}, zoom = {};
const choices = all("select[data-choice]");

/* The fragment keeps the view: what is hidden, how tables are sorted, how far plots are zoomed. */
function write() {
  const parts = [];
  if ([...hidden].sort().join() !== [...atFirst].sort().join()) parts.push("off=" + [...hidden].join("."));
  for (const [name, [column, up]] of Object.entries(sorted)) parts.push(`sort=${name}.${column}.${up ? "up" : "down"}`);
  for (const [link, [a, b]] of Object.entries(zoom)) parts.push(`zoom=${link}.${Math.round(1e4 * a)}.${Math.round(1e4 * b)}`);
  for (const c of choices) if (c.selectedIndex > 0) parts.push(`show=${c.dataset.choice}.${c.selectedIndex}`);
  history.replaceState(null, "", parts.length ? "#" + parts.join("&") : location.pathname + location.search);
}
function read() {
  hidden = new Set(atFirst); zoom = {};
  for (const c of choices) choose(c, 0);
  for (const part of location.hash.slice(1).split("&")) {
    const [key, value = ""] = part.split("="), words = value.split(".");
    if (key === "off") hidden = new Set(words.filter((w) => /^\d+$/.test(w)));
    if (key === "sort" && words.length === 3) sortBy(words[0], +words[1], words[2] === "up");
    if (key === "show") for (const c of choices) if (c.dataset.choice === words[0]) choose(c, +words[1]);
    if (key === "zoom" && words.length === 3) {
      const [a, b] = words.slice(1).map((w) => +w / 1e4);
      if (a >= 0 && b <= 1 && b > a) zoom[words[0]] = [a, b];
    }
  }
  paint(); draw();
}

/* Of plots to choose from, the one that is chosen is shown. */
function choose(select, at) {
  if (!select.options[at]) return;
  select.selectedIndex = at;
  for (const o of select.options) document.getElementById(o.value).hidden = !o.selected;
}
for (const c of choices) c.addEventListener("change", () => { choose(c, c.selectedIndex); write(); });

/* One legend rules all plots: a style sheet hides and fades by the number of the policy. */
function paint() {
  const drawn = ":is(.plot,.pictures)";
  const rules = [...hidden].map((p) => `${drawn} [data-p="${p}"]{display:none}`);
  if (hot !== null && !hidden.has(hot)) rules.push(`${drawn} [data-p]:not([data-p="${hot}"]){opacity:.12}`);
  off.textContent = rules.join("");
  for (const b of names) b.setAttribute("aria-pressed", String(!hidden.has(b.dataset.p)));
  for (const plot of all(".plot")) spread(plot);
}

/* Labels of what is drawn stand beside their points, as near as there is room. */
function spread(plot) {
  const marks = all(".mark", plot).filter((m) => !hidden.has(m.dataset.p));
  const several = new Set(marks.map((m) => m.dataset.p)).size < marks.length;
  if (!plot.querySelector(".label") || !marks.length || several) return;
  const room = 1700 / parseFloat(plot.querySelector(".area").style.height), of = (m) => parseFloat(m.style.bottom);
  marks.sort((a, b) => of(a) - of(b) || parseFloat(b.style.left) - parseFloat(a.style.left));
  let end = room / 2;
  const places = marks.map((m) => { const at = Math.max(of(m), end); end = at + room; return at; });
  end = 100 - room / 2;
  for (let i = places.length - 1; i >= 0; i--) { places[i] = Math.min(places[i], end); end = places[i] - room; }
  marks.forEach((m, i) => {
    const p = m.dataset.p, leader = plot.querySelector(`path.leader[data-p="${p}"]`);
    plot.querySelector(`.label[data-p="${p}"]`).style.bottom = places[i] + "%";
    const at = (share, size) => Math.round(size * share / 100);
    leader.setAttribute("d", `M${at(parseFloat(m.style.left), WIDE)} ${at(100 - of(m), HIGH)}L${WIDE} ${at(100 - places[i], HIGH)}`);
  });
}
for (const b of names) {
  const p = b.dataset.p;
  b.addEventListener("click", () => { hidden.has(p) ? hidden.delete(p) : hidden.add(p); paint(); write(); });
  b.addEventListener("pointerenter", () => { hot = p; paint(); });
  b.addEventListener("focus", () => { if (b.matches(":focus-visible")) { hot = p; paint(); } });
  for (const event of ["pointerleave", "blur"]) b.addEventListener(event, () => { hot = null; paint(); });
}
for (const b of all("[data-show]")) b.addEventListener("click", () => {
  hidden = new Set(b.dataset.show === "all" ? [] : atFirst); paint(); write();
});

/* Tables sort by a column, within each group of rows; what has no value stands last. */
function sortBy(name, column, up) {
  for (const table of all("table[data-sort]")) {
    if (table.dataset.sort !== name || !table.tHead.rows[0].cells[column]) continue;
    sorted[name] = [column, up];
    all("th", table.tHead).forEach((th, i) => i === column
      ? th.setAttribute("aria-sort", up ? "ascending" : "descending") : th.removeAttribute("aria-sort"));
    const of = (row) => {
      const cell = row.cells[column];
      return cell.dataset.v !== undefined ? +cell.dataset.v : cell.textContent.trim().toLowerCase();
    };
    for (const body of table.tBodies) {
      let group = [];
      const end = (before) => {
        const keyed = group.map((row, i) => [of(row), i, row]);
        keyed.sort(([a, i], [b, j]) => {
          const none = (a === "" || a === "–") - (b === "" || b === "–");
          const order = typeof a === "number" && typeof b === "number" ? a - b
            : typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === "number" ? -1 : 1;
          return none || (up ? order : -order) || i - j;
        });
        for (const [, , row] of keyed) body.insertBefore(row, before);
        group = [];
      };
      for (const row of [...body.rows]) row.className === "group" ? end(row) : group.push(row);
      end(null);
    }
  }
}
for (const table of all("table[data-sort]")) all("button.sort", table).forEach((b, i) =>
  b.addEventListener("click", () => {
    const [column, up] = sorted[table.dataset.sort] || [];
    sortBy(table.dataset.sort, i, column === i ? !up : true); write();
  }));

/* Axes: from a share of the plot to the value there, and back to texts. */
function axis(text) {
  const [low, high, scale] = text.split(" "), [to, from] = {
    log: [Math.log, Math.exp], root: [Math.sqrt, (v) => v * v], linear: [(v) => v, (v) => v],
  }[scale];
  const a = to(+low), b = to(+high);
  return (share) => from(a + share * (b - a));
}
const digits = (v) => Math.abs(v) >= 1000 ? Math.round(v).toLocaleString("en") : String(+v.toPrecision(3));

/* Zoom along x: the view box of linked plots, and their ticks. */
const linked = all(".plot[data-link]");
for (const plot of linked) plot.ticks = all(".xt", plot).map((t) => [t.style.left, t.textContent]);
function draw() {
  for (const plot of linked) {
    const [a, b] = zoom[plot.dataset.link] || [0, 1], area = plot.querySelector(".area");
    
    for (const svg of all("svg", area)) svg.setAttribute("viewBox", `${WIDE * a} 0 ${WIDE * (b - a)} ${HIGH}`);
    let ticks = plot.ticks;
    if (b - a < 1) {
      const at = axis(plot.dataset.x), from = at(a), to = at(b), power = 10 ** Math.floor(Math.log10((to - from) / 8));
      const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= (to - from) / 8);
      ticks = [];
      for (let v = Math.ceil(from / step) * step; v <= to; v += step) ticks.push([100 * (v - from) / (to - from) + "%", String(+v.toPrecision(6))]);
    }
    all(".xt", area).forEach((t) => t.remove());
    for (const [left, text] of ticks) {
      const t = document.createElement("span");
      t.className = "xt"; t.style.left = left; t.textContent = text; area.append(t);
    }
  }
}
function zoomTo(link, a, b) {
  const size = Math.min(Math.max(b - a, 0.005), 1);
  a = Math.min(Math.max(a, 0), 1 - size);
  if (size >= 1) delete zoom[link]; else zoom[link] = [a, a + size];
  draw(); write();
}
function act(link, what) {
  const [a, b] = zoom[link] || [0, 1], middle = (a + b) / 2, size = b - a;
  if (what === "in") zoomTo(link, middle - size / 4, middle + size / 4);
  if (what === "out") zoomTo(link, middle - size, middle + size);
  if (what === "left") zoomTo(link, a - size / 4, b - size / 4);
  if (what === "right") zoomTo(link, a + size / 4, b + size / 4);
  if (what === "all") zoomTo(link, 0, 1);
}
for (const b of all("[data-zoom]")) b.addEventListener("click", () => act(b.dataset.link, b.dataset.zoom));
const KEYS = { "+": "in", "=": "in", "-": "out", ArrowLeft: "left", ArrowRight: "right", 0: "all", Escape: "all" };

/* The value nearest to the pointer, and dragging to zoom. */
function points(path) {
  if (!path.points) {
    const [first, rest = ""] = path.getAttribute("d").slice(1).split("l");
    let [x, y] = first.split(" ").map(parseFloat);
    const found = [[x, y]], steps = rest.split(" ").map(Number);
    for (let i = 0; i + 1 < steps.length; i += 2) found.push([x += steps[i], y += steps[i + 1]]);
    path.points = found;
  }
  return path.points;
}
const nameOf = (p) => (names.find((b) => b.dataset.p === p) || { textContent: "" }).textContent;
for (const plot of all(".plot")) {
  const area = plot.querySelector(".area"), link = plot.dataset.link, tip = document.createElement("div");
  const xAt = axis(plot.dataset.x), yAt = axis(plot.dataset.y);
  let from = null, brush = null;
  tip.className = "tip"; tip.hidden = true; area.append(tip);
  const share = (event) => {
    const box = area.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height, box];
  };
  function near(px, py, box) {
    const [a, b] = zoom[link] || [0, 1];
    let best = 30 * 30, found = null;
    for (const mark of all(".mark[data-t]", area)) {
      if (hidden.has(mark.dataset.p)) continue;
      const dx = mark.offsetLeft + 5.5 - px * box.width, dy = mark.offsetTop + 5.5 - py * box.height;
      if (dx * dx + dy * dy < 100) return mark.dataset.t;
    }
    for (const path of all("path.line", area)) {
      if (hidden.has(path.dataset.p)) continue;
      for (const [x, y] of points(path)) {
        const dx = ((x / WIDE - a) / (b - a) - px) * box.width, dy = (y / HIGH - py) * box.height;
        if (dx * dx + dy * dy < best) { best = dx * dx + dy * dy; found = [path.dataset.n || nameOf(path.dataset.p), x, y]; }
      }
    }
    return found && `${found[0]}: ${plot.dataset.xt} ${digits(xAt(found[1] / WIDE))}; ${plot.dataset.yt} ${digits(yAt(1 - found[2] / HIGH))}`;
  }
  area.addEventListener("pointermove", (event) => {
    const [px, py, box] = share(event);
    if (brush) {
      brush.style.left = 100 * Math.min(from, px) + "%"; brush.style.width = 100 * Math.abs(px - from) + "%";
      return;
    }
    const text = (event.target.closest("path[data-t]") || { dataset: {} }).dataset.t || near(px, py, box);
    tip.hidden = !text;
    if (!text) return;
    tip.textContent = text;
    tip.style.left = px < .5 ? px * box.width + 14 + "px" : "auto";
    tip.style.right = px < .5 ? "auto" : (1 - px) * box.width + 14 + "px";
    tip.style.top = py * box.height + 14 + "px";
  });
  area.addEventListener("pointerleave", () => { tip.hidden = true; });
  if (!link) continue;
  area.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    [from] = share(event); area.setPointerCapture(event.pointerId); tip.hidden = true;
    brush = document.createElement("div"); brush.className = "brush"; area.append(brush);
  });
  const end = (event) => {
    if (!brush) return;
    brush.remove(); brush = null;
    const [to] = share(event), [a, b] = zoom[link] || [0, 1];
    if (event.type === "pointerup" && Math.abs(to - from) > .01)
      zoomTo(link, a + Math.min(from, to) * (b - a), a + Math.max(from, to) * (b - a));
  };
  area.addEventListener("pointerup", end); area.addEventListener("pointercancel", end);
  area.addEventListener("dblclick", () => act(link, "all"));
  area.addEventListener("keydown", (event) => {
    if (KEYS[event.key] && !event.ctrlKey && !event.metaKey && !event.altKey) { event.preventDefault(); act(link, KEYS[event.key]); }
  });
}

for (const b of all("[data-copy]")) {
  b.hidden = false;
  b.addEventListener("click", () => {
    getSelection().selectAllChildren(b.parentNode.querySelector("code"));
    document.execCommand("copy"); b.textContent = "Copied";
  });
}
let opened = [];
addEventListener("beforeprint", () => { opened = all("details:not([open])"); for (const d of opened) d.open = true; });
addEventListener("afterprint", () => { for (const d of opened) d.open = false; });
addEventListener("hashchange", read);
read();
})();
