"use strict";
(async () => {
const all = (query, at = document) => [...at.querySelectorAll(query)];
const one = (query, at = document) => at.querySelector(query);
const SHADES = ["#3b528b", "#2c728e", "#24868e", "#1fa088", "#42be71", "#7ad151", "#b5de2b", "#fde725"];
const RECENT_S = 0.25, SAME_S = 1e-6, SMOOTH_MS = 40, REST_MS = 150, SPHERE = -1, ROUGH = -2;

/* The arrays of the page, by name. */
const head = JSON.parse(one("#head").textContent);
const arrays = await (async () => {
  const text = atob(one("#data").textContent), packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = await new Response(stream).arrayBuffer(), found = {};
  for (const [name, [kind, at, length]] of Object.entries(head.arrays)) found[name] = new globalThis[kind](bytes, at, length);
  return found;
})();
one("#data").remove();
const N = arrays.type.length, moving = arrays.moving || new Int32Array(0), circle = arrays.circle;
const rowOf = (node, level) => arrays.first_row[arrays.type[node]] + level;
function shadeOf(node, level) {
  const last = arrays.levels[arrays.type[node]] - 1;
  return Math.round(7 * (last ? 1 - level / last : arrays.depth[node]));
}

/* A policy's replay: its levels at any frame, from one that is kept before it. */
const policies = head.policies.map((name, at) => {
  const mine = (what) => arrays[`p${at}/${what}`];
  const p = { name, time: mine("time_s"), work: mine("work_ms"), eye: mine("camera_m"), turn: mine("camera_turn"),
    start: mine("start"), node: mine("node"), level: mine("level"), isSwitch: mine("switch") };
  p.frames = p.time.length; p.levels = new Int16Array(N).fill(-1); p.at = -1;
  p.every = Math.max(32, Math.ceil(p.frames * N / 2 ** 25)); p.kept = [];
  p.switches = []; p.before = new Int32Array(p.frames + 1);
  for (let f = 0; f < p.frames; f++) {
    let count = 0;
    for (let c = p.start[f]; c < p.start[f + 1]; c++) { p.levels[p.node[c]] = p.level[c]; count += p.isSwitch[c]; }
    if (f % p.every === 0) p.kept.push(p.levels.slice());
    p.before[f + 1] = p.before[f] + count;
    if (count) p.switches.push(f);
  }
  p.at = p.frames - 1;
  return p;
});
function frameAt(p, time) {
  let low = 0, high = p.frames - 1;
  while (low < high) { const mid = (low + high + 1) >> 1; if (p.time[mid] <= time + SAME_S) low = mid; else high = mid - 1; }
  return low;
}
/* One replay may be on both sides: its levels are those of the frame that was asked for last. */
function levelsAt(p, frame) {
  if (frame < p.at || frame - p.at > p.every) {
    const k = Math.floor(frame / p.every);
    p.levels.set(p.kept[k]); p.at = k * p.every;
  }
  while (p.at < frame) {
    p.at++;
    for (let c = p.start[p.at]; c < p.start[p.at + 1]; c++) p.levels[p.node[c]] = p.level[c];
  }
  return p.levels;
}

/* Where nodes are: some go round circles through their place of rest. */
const moved = new Float32Array(2 * moving.length), place = new Int32Array(N).fill(-1);
moving.forEach((node, m) => { place[node] = m; });
function move(time) {
  for (let m = 0; m < moving.length; m++) {
    const radius = circle[3 * m], phase = circle[3 * m + 2], angle = circle[3 * m + 1] * time + phase;
    moved[2 * m] = radius * (Math.cos(angle) - Math.cos(phase));
    moved[2 * m + 1] = radius * (Math.sin(angle) - Math.sin(phase));
  }
}

/* Matrices of nodes, for their own mesh and for a sphere in its place. */
const own = new Float32Array(16 * N), sphere = new Float32Array(16 * N);
{
  const m = new THREE.Matrix4(), q = new THREE.Quaternion(), v = new THREE.Vector3(), s = new THREE.Vector3();
  for (let n = 0; n < N; n++) {
    q.fromArray(arrays.turn_xyzw, 4 * n); v.fromArray(arrays.position_m, 3 * n); s.setScalar(arrays.scale[n]);
    m.compose(v, q, s).toArray(own, 16 * n);
    v.fromArray(arrays.center_m, 3 * n); s.setScalar(0.6 * arrays.radius_m[n]);
    m.compose(v, q.identity(), s).toArray(sphere, 16 * n);
  }
}
const perType = new Int32Array(arrays.first_row.length);
for (let n = 0; n < N; n++) perType[arrays.type[n]]++;
const capacity = new Int32Array(head.boxes.length);
arrays.first_row.forEach((first, type) => {
  const held = new Set();
  for (let level = 0; level < arrays.levels[type]; level++) held.add(arrays.mesh_of_row[first + level]);
  for (const mesh of held) if (mesh >= 0) capacity[mesh] += perType[type];
});
function geometryOf(mesh) {
  if (mesh < 0) return mesh === SPHERE ? new THREE.IcosahedronGeometry(1, 1) : new THREE.OctahedronGeometry(1.2);
  const grid = arrays[`mesh${mesh}/vertices`], [low, size] = head.boxes[mesh], points = new Float32Array(grid.length);
  for (let i = 0; i < grid.length; i++) points[i] = low[i % 3] + size[i % 3] * grid[i] / 65535;
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
  geometry.setIndex(new THREE.BufferAttribute(arrays[`mesh${mesh}/faces`], 1));
  return geometry;
}
const geometries = new Map();
const sharedGeometry = (mesh) => {
  if (!geometries.has(mesh)) geometries.set(mesh, geometryOf(mesh));
  return geometries.get(mesh);
};
const PIXELS = SHADES.map((text) => new Uint32Array(new Uint8Array([1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16)).concat(255)).buffer)[0]);
const colors = SHADES.map((text) => new THREE.Color(text));

/* The extent of what is seen from above: nodes and the camera's way. */
const extent = [Infinity, Infinity, -Infinity, -Infinity];
const reach = (x, y) => {
  extent[0] = Math.min(extent[0], x); extent[1] = Math.min(extent[1], y);
  extent[2] = Math.max(extent[2], x); extent[3] = Math.max(extent[3], y);
};
for (let n = 0; n < N; n++) reach(arrays.center_m[3 * n], arrays.center_m[3 * n + 1]);
for (const p of policies) for (let f = 0; f < p.frames; f += 8) reach(p.eye[3 * f], p.eye[3 * f + 1]);
const span = Math.max(extent[2] - extent[0], extent[3] - extent[1], 1);

/* Whether triangles are drawn by the processor: then edges are not smoothed. */
const SOFTWARE = (() => {
  const gl = document.createElement("canvas").getContext("webgl2"), more = gl && gl.getExtension("WEBGL_debug_renderer_info");
  const name = more ? gl.getParameter(more.UNMASKED_RENDERER_WEBGL) : "";
  if (gl) gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
})();

class Pane {
  constructor(root, at) {
    this.root = root; this.meshes = new Map(); this.counts = new Map(); this.frame = -1;
    this.eye = one(".eye", root); this.above = one(".above", root); this.says = one(".says", root);
    this.select = one("select", root);
    head.policies.forEach((name, i) => this.select.add(new Option(name, i)));
    this.choose(at);
    this.select.addEventListener("change", () => { this.choose(this.select.selectedIndex); plot(); ask(); });
    this.eye.style.aspectRatio = head.aspect;
    try {
      this.renderer = new THREE.WebGLRenderer({ canvas: this.eye, antialias: !SOFTWARE });
      this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    } catch {
      one("#failed").hidden = false;
      one("#failed").textContent = "This browser has no WebGL: the scene is shown from above alone.";
    }
    this.scene = new THREE.Scene(); this.scene.background = new THREE.Color("#171b21");
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x9a9aa0, 2.6));
    const sun = new THREE.DirectionalLight(0xffffff, 1.6);
    sun.position.set(-0.45, -0.35, 0.82); this.scene.add(sun);
    this.camera = new THREE.PerspectiveCamera(head.fovy_deg, head.aspect, 0.1, 20 * span);
    this.material = new THREE.MeshLambertMaterial({ flatShading: true, side: THREE.DoubleSide });
    new ResizeObserver(() => { this.size(); ask(); }).observe(root);
  }
  choose(at) { this.policy = policies[at]; this.select.selectedIndex = at; this.frame = -1; }
  size() {
    this.frame = -1;
    const width = this.eye.clientWidth;
    if (this.renderer && width) this.renderer.setSize(width, Math.round(width / head.aspect), false);
    this.above.width = Math.round(this.above.clientWidth * Math.min(devicePixelRatio, 2));
    this.above.height = Math.round(this.above.width / 2);
    this.ground = null;
  }
  mesh(at) {
    if (!this.meshes.has(at)) {
      const many = at < 0 ? N : capacity[at], mesh = new THREE.InstancedMesh(sharedGeometry(at), this.material, many);
      mesh.instanceColor = new THREE.InstancedBufferAttribute(new Float32Array(3 * many), 3);
      mesh.count = 0; mesh.frustumCulled = false; mesh.matrixAutoUpdate = false;
      this.meshes.set(at, mesh); this.scene.add(mesh);
    }
    return this.meshes.get(at);
  }
  /* A rough picture has octahedra for all meshes, in the colours of their levels. */
  draw(time, rough) {
    const p = this.policy, frame = frameAt(p, time);
    if (frame === this.frame && rough === this.rough) return;
    this.frame = frame; this.rough = rough;
    const levels = levelsAt(p, frame);
    move(p.time[frame]);
    const drawn = [[], [], [], [], [], [], [], []];
    let count = 0;
    for (let n = 0; n < N; n++) if (levels[n] >= 0) { drawn[shadeOf(n, levels[n])].push(n); count++; }
    if (this.renderer) this.drawEye(drawn, levels);
    this.drawAbove(drawn);
    const now = p.before[frame + 1] - p.before[frame];
    this.says.textContent = `Frame ${frame}, ${p.time[frame].toFixed(3)} s: work ${p.work[frame].toPrecision(3)} ms, `
      + `${count} drawn, ${now} ${now === 1 ? "switch" : "switches"} now, ${p.before[frame + 1]} so far`;
    this.root.dataset.frame = frame; this.root.dataset.time = p.time[frame];
  }
  drawEye(drawn, levels) {
    for (const mesh of this.meshes.values()) mesh.count = 0;
    drawn.forEach((nodes, shade) => {
      const { r, g, b } = colors[shade];
      for (const n of nodes) {
        const at = this.rough ? ROUGH : arrays.mesh_of_row[rowOf(n, levels[n])], mesh = this.mesh(at), from = at < 0 ? sphere : own;
        const i = mesh.count, to = mesh.instanceMatrix.array, tint = mesh.instanceColor.array;
        for (let k = 0; k < 16; k++) to[16 * i + k] = from[16 * n + k];
        if (place[n] >= 0) { to[16 * i + 12] += moved[2 * place[n]]; to[16 * i + 13] += moved[2 * place[n] + 1]; }
        tint[3 * i] = r; tint[3 * i + 1] = g; tint[3 * i + 2] = b;
        mesh.count = i + 1;
      }
    });
    for (const mesh of this.meshes.values()) {
      mesh.visible = mesh.count > 0; mesh.instanceMatrix.needsUpdate = true; mesh.instanceColor.needsUpdate = true;
      for (const [attribute, width] of [[mesh.instanceMatrix, 16], [mesh.instanceColor, 3]]) {
        attribute.clearUpdateRanges(); attribute.addUpdateRange(0, width * mesh.count);
      }
    }
    const p = this.policy, f = this.frame;
    this.camera.position.fromArray(p.eye, 3 * f); this.camera.quaternion.fromArray(p.turn, 4 * f);
    this.renderer.render(this.scene, this.camera);
  }
  drawAbove(drawn) {
    const draw = this.above.getContext("2d"), { width, height } = this.above, p = this.policy, f = this.frame;
    if (!width) return;
    const dx = extent[2] - extent[0] || 1, dy = extent[3] - extent[1] || 1, unit = 0.94 * Math.min(width / dx, height / dy);
    const X = (x) => width / 2 + unit * (x - (extent[0] + extent[2]) / 2), Y = (y) => height / 2 - unit * (y - (extent[1] + extent[3]) / 2);
    const at = (n) => {
      const m = place[n];
      return [X(arrays.center_m[3 * n] + (m < 0 ? 0 : moved[2 * m])), Y(arrays.center_m[3 * n + 1] + (m < 0 ? 0 : moved[2 * m + 1]))];
    };
    const sizeOf = (n) => Math.min(Math.max(unit * arrays.radius_m[n], 2), height / 12);
    if (!this.ground) {
      const dim = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
      dim.fillStyle = "#171b21"; dim.fillRect(0, 0, width, height); dim.fillStyle = "#39414c";
      for (let n = 0; n < N; n++) if (place[n] < 0) { const [x, y] = at(n), s = Math.min(sizeOf(n), 3); dim.fillRect(x - s / 2, y - s / 2, s, s); }
      dim.strokeStyle = "#8b95a3"; dim.lineWidth = 1; dim.beginPath();
      for (let g = 0; g < p.frames; g++) dim.lineTo(X(p.eye[3 * g]), Y(p.eye[3 * g + 1]));
      dim.stroke();
      this.ground = new Uint32Array(dim.getImageData(0, 0, width, height).data.buffer);
      this.picture = new ImageData(width, height);
    }
    /* Squares are written as pixels, many times as fast as by the canvas. */
    const pixels = new Uint32Array(this.picture.data.buffer);
    pixels.set(this.ground);
    drawn.forEach((nodes, shade) => {
      for (const n of nodes) {
        const [x, y] = at(n), s = sizeOf(n), left = Math.max(Math.round(x - s / 2), 0), right = Math.min(Math.round(x + s / 2), width);
        for (let row = Math.max(Math.round(y - s / 2), 0); row < Math.min(Math.round(y + s / 2), height); row++)
          if (right > left) pixels.fill(PIXELS[shade], row * width + left, row * width + right);
      }
    });
    draw.putImageData(this.picture, 0, 0);
    draw.strokeStyle = "#ffffff"; draw.lineWidth = Math.max(0.75, width / 500);
    for (let g = frameAt(p, p.time[f] - RECENT_S); g <= f; g++)
      for (let c = p.start[g]; c < p.start[g + 1]; c++) if (p.isSwitch[c] && p.time[g] > p.time[f] - RECENT_S) {
        const [x, y] = at(p.node[c]);
        draw.beginPath(); draw.arc(x, y, sizeOf(p.node[c]) + Math.max(1.5, width / 240), 0, 2 * Math.PI); draw.stroke();
      }
    const eye = [X(p.eye[3 * f]), Y(p.eye[3 * f + 1])], ahead = new THREE.Vector3(0, 0, -1).applyQuaternion(new THREE.Quaternion().fromArray(p.turn, 4 * f));
    const turn = Math.atan2(-ahead.y, ahead.x), half = Math.atan(Math.tan(head.fovy_deg * Math.PI / 360) * head.aspect);
    draw.fillStyle = "#ffffff44"; draw.beginPath(); draw.moveTo(...eye); draw.arc(...eye, height / 4, turn - half, turn + half); draw.fill();
    draw.fillStyle = "#ffffff"; draw.beginPath(); draw.arc(...eye, 4, 0, 2 * Math.PI); draw.fill();
  }
}

const panes = all(".pane").map((root, side) => new Pane(root, Math.min(side, policies.length - 1)));

/* The plot of frame times: a line for each side, the budget, and when each switches. */
const times = one(".times"), board = one("canvas", times), scrub = one(".scrub"), cursor = one(".cursor");
const END = Math.max(...policies.map((p) => p.time[p.frames - 1])), STEP = 1 / head.refresh_hz;
let now = 0, playing = null;
scrub.max = END; scrub.step = STEP;
function plot() {
  const width = board.width = Math.round(times.clientWidth * Math.min(devicePixelRatio, 2)), height = board.height = Math.round(times.clientHeight * Math.min(devicePixelRatio, 2));
  const draw = board.getContext("2d"), style = getComputedStyle(document.documentElement), color = (name) => style.getPropertyValue(name).trim();
  const top = 2 * head.budget_ms, floor = height - 30 * height / times.clientHeight, X = (t) => width * t / END, Y = (ms) => floor * (1 - Math.min(ms / top, 1));
  draw.strokeStyle = color("--dim"); draw.setLineDash([5, 4]); draw.beginPath(); draw.moveTo(0, Y(head.budget_ms)); draw.lineTo(width, Y(head.budget_ms)); draw.stroke(); draw.setLineDash([]);
  panes.forEach((pane, side) => {
    const p = pane.policy; draw.strokeStyle = draw.fillStyle = color(["--c0", "--c1"][side]);
    pane.root.style.borderTop = `3px solid ${draw.strokeStyle}`;
    draw.beginPath();
    for (let f = 0; f < p.frames; f++) draw.lineTo(X(p.time[f]), Y(p.work[f]));
    draw.stroke();
    const band = (height - floor) / 2;
    for (const f of p.switches) draw.fillRect(X(p.time[f]), floor + side * band + 2, 1.5, band - 3);
  });
}

/* Both sides show the frame that began last at one time of the path.  Where whole pictures take too
   long to follow the scrubber, what moves is rough, and what rests is whole. */
let asked = false, before = -Infinity, late = 0, resting = 0, slow = SOFTWARE;
function rest() {
  clearTimeout(resting);
  resting = setTimeout(() => { if (!playing && slow) requestAnimationFrame(() => { for (const pane of panes) pane.draw(now, false); }); }, REST_MS);
}
function ask() {
  if (asked) return;
  asked = true;
  requestAnimationFrame((stamp) => {
    asked = false;
    if (playing) {
      now = playing.from + (stamp - playing.since) / 1000;
      if (now >= END) { now = END; stop(); }
      scrub.value = now;
    }
    const passed = stamp - before;
    if (passed > SMOOTH_MS && passed < 25 * SMOOTH_MS && panes.some((pane) => pane.rough === false)) late++; else late = 0;
    if (late >= 3) slow = true;
    before = stamp;
    for (const pane of panes) pane.draw(now, slow);
    if (slow) rest();
    cursor.style.left = 100 * now / END + "%";
    one(".at").textContent = `${now.toFixed(2)} of ${END.toFixed(2)} s`;
    if (!document.documentElement.dataset.ready) { document.documentElement.dataset.ready = "1"; performance.mark("first-picture"); }
    if (playing) ask();
  });
}
function seek(time) { stop(); now = Math.min(Math.max(time, 0), END); scrub.value = now; keep(); ask(); }
function stop() { playing = null; one("[data-do=play]").textContent = "Play"; }
function play() {
  if (playing) { stop(); keep(); return; }
  playing = { from: now >= END ? 0 : now, since: performance.now() };
  one("[data-do=play]").textContent = "Pause"; ask();
}
/* The next time at which either side begins a frame with a switch. */
function step(way) {
  let best = null;
  for (const { policy: p } of panes) for (const f of p.switches) {
    const t = p.time[f];
    if (way > 0 ? t > now + SAME_S && (best === null || t < best) : t < now - SAME_S && (best === null || t > best)) best = t;
  }
  if (best !== null) seek(best);
}
function keep() { history.replaceState(null, "", `#t=${now.toFixed(6)}&sides=${panes.map((p) => p.select.selectedIndex).join(".")}`); }
function read() {
  const words = new URLSearchParams(location.hash.slice(1)), sides = (words.get("sides") || "").split(".");
  panes.forEach((pane, i) => { if (sides[i] && policies[+sides[i]]) pane.choose(+sides[i]); });
  if (words.get("t")) { now = Math.min(Math.max(+words.get("t") || 0, 0), END); scrub.value = now; }
  plot(); ask();
}
scrub.addEventListener("input", () => { stop(); now = +scrub.value; keep(); ask(); });
const pointed = (event) => { const box = times.getBoundingClientRect(); seek(END * (event.clientX - box.left) / box.width); };
times.addEventListener("pointerdown", (event) => { times.setPointerCapture(event.pointerId); pointed(event); });
times.addEventListener("pointermove", (event) => { if (event.buttons) pointed(event); });
for (const b of all("[data-do]")) b.addEventListener("click", () => ({ back: () => step(-1), next: () => step(1), play })[b.dataset.do]());
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest("select, button")) return;
  const does = { n: () => step(1), p: () => step(-1), " ": play }[event.key.toLowerCase()];
  if (does) { event.preventDefault(); does(); }
});
new ResizeObserver(plot).observe(times);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", plot);
addEventListener("hashchange", read);
for (const pane of panes) pane.size();
read();
})();
