"use strict";
(async function () {
  const place = document.getElementById("view");
  if (typeof DecompressionStream === "undefined") {
    place.textContent = "This browser cannot show the view: it is of before 2023.";
    return;
  }
  async function unpacked(id) {
    const packed = decoded(document.getElementById(id).textContent, Uint8Array);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  }
  const library = document.createElement("script");
  library.textContent = await unpacked("view-plotly");
  document.head.append(library);
  const data = JSON.parse(await unpacked("view-data"));

  function decoded(text, Kind) {
    const raw = atob(text);
    const bytes = new Uint8Array(raw.length);
    for (let n = 0; n < raw.length; n++) bytes[n] = raw.charCodeAt(n);
    return new Kind(bytes.buffer);
  }
  function column(values, number, width) {
    const found = new values.constructor(values.length / width);
    for (let n = 0; n < found.length; n++) found[n] = values[width * n + number];
    return found;
  }
  const axes = [0, 1, 2];
  const points = decoded(data.points, Float32Array);
  const floats = (texts) => texts && texts.map((text) => text && decoded(text, Float32Array));
  const moves = floats(data.displacement);
  const ends = decoded(data.lines, Int32Array);
  const triangles = decoded(data.triangles, Int32Array);
  const partOfPoints = decoded(data.partOfPoints, Int32Array);
  const status = floats(data.status);
  data.fields.forEach((field) => { field.values = floats(field.values); });
  const obstacle = floats(data.obstacle);
  const obstacleTriangles = decoded(data.obstacleTriangles, Int32Array);
  const obstacleLines = decoded(data.obstacleLines, Int32Array);
  const chosen = {
    field: 0, factor: data.factors.length - 1, zone: data.zone ? 1 : 0, lines: 0, obstacle: 0,
    step: data.times.length - 1,
  };
  // Of each connected part: its points, and its triangles by their numbers among these.
  const parts = data.parts.map((_, part) => {
    chosen["part" + part] = 0;
    const number = new Int32Array(partOfPoints.length).fill(-1);
    const own = [];
    partOfPoints.forEach((of, n) => { if (of === part) number[n] = own.push(n) - 1; });
    const sides = [[], [], []];
    const numbers = [];
    for (let n = 0; n < triangles.length; n += 3) {
      if (partOfPoints[triangles[n]] !== part) continue;
      axes.forEach((corner) => sides[corner].push(number[triangles[n + corner]]));
      numbers.push(n);
    }
    return { points: own, corners: sides, triangles: numbers };
  });
  // 0: shown, 1: faded, 2: hidden
  const stateOf = (part) => chosen["part" + part];

  function moved(axis, factor, by = moves[chosen.step]) {
    return column(points, axis, 3).map((x, n) => x + factor * by[3 * n + axis]);
  }
  // The same box for all displacements, so that one sees them when one changes between them; with
  // room for lines that lie a little before the surface.
  function boxOf(axis) {
    let low = Infinity, high = -Infinity;
    function hold(x) {
      low = Math.min(low, x);
      high = Math.max(high, x);
    }
    data.factors.forEach((factor) => data.times.forEach((_, step) => {
      moved(axis, factor, moves[step]).forEach(hold);
      if (!obstacle || !obstacle[step]) return;
      const stands = moved(axis, factor, obstacle[step]);
      (data.flat ? obstacleLines : obstacleTriangles).forEach((n) => hold(stands[n]));
    }));
    return [low - 0.02 * (high - low), high + 0.02 * (high - low)];
  }
  const whole = axes.map(boxOf);
  // Unit normals at the points: lines lie a little before the surface.
  const outward = new Float32Array(points.length);
  for (let n = 0; n < triangles.length; n += 3) {
    const [a, b, c] = axes.map((corner) => 3 * triangles[n + corner]);
    const side = (from, to) => axes.map((axis) => points[to + axis] - points[from + axis]);
    const [u, v] = [side(a, b), side(a, c)];
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const size = Math.hypot(...normal) || 1;
    [a, b, c].forEach((at) => axes.forEach((axis) => { outward[at + axis] += normal[axis] / size; }));
  }
  for (let n = 0; n < outward.length; n += 3) {
    const size = Math.hypot(outward[n], outward[n + 1], outward[n + 2]) || 1;
    axes.forEach((axis) => { outward[n + axis] /= size; });
  }
  function box() {
    const shown = chosen.zone === 0 ? whole.slice() : axes.map((n) => [
      Math.max(data.zone[0][n], whole[n][0]), Math.min(data.zone[1][n], whole[n][1]),
    ]);
    if (data.flat) shown[2] = [-depth(shown), depth(shown)];
    return shown;
  }
  // Of a plane body, which has none: lines and points lie before it by shares of this.
  function depth(shown) {
    return 0.05 * Math.max(...shown.slice(0, 2).map((range) => range[1] - range[0]));
  }
  function written(value) { return Number(value.toPrecision(4)).toString(); }
  function wordsOf(n) {
    const at = axes.slice(0, data.flat ? 2 : 3).map((axis) => written(points[3 * n + axis]));
    const lines = ["at (" + at.join(", ") + ")" + (data.unit && " " + data.unit)];
    data.fields.forEach((f) => {
      const value = written(f.values[chosen.step][n]) + (f.unit && " " + f.unit);
      lines.push(f.name + " " + f.symbol + " = " + value);
    });
    const state = status && status[chosen.step][n];
    if (status && state >= 0) lines.push(data.statusNames[Math.round(state)]);
    return lines.join("<br>");
  }
  const wordsAt = {};
  function words() {
    const step = chosen.step;
    wordsAt[step] = wordsAt[step] || Array.from(partOfPoints, (_, n) => wordsOf(n));
    return wordsAt[step];
  }

  function isNarrow() { return place.clientWidth < 520; }
  function body(x, y, z, part, hasBar) {
    const { points: own, corners, triangles: numbers } = parts[part];
    const texts = words();
    const of = (values) => own.map((n) => values[n]);
    const mesh = {
      type: "mesh3d", x: of(x), y: of(y), z: of(z), i: corners[0], j: corners[1], k: corners[2],
      text: of(texts), hoverinfo: "text", flatshading: true, name: data.parts[part],
      opacity: stateOf(part) === 1 ? 0.15 : 1, showscale: hasBar,
      lighting: data.flat
        ? { ambient: 1, diffuse: 0, specular: 0, fresnel: 0 }
        : { ambient: 0.8, diffuse: 0.35, specular: 0.05, roughness: 0.9, fresnel: 0 },
      lightposition: { x: 1e4 * data.towards[0], y: 5e3 * data.towards[1], z: 2e4 },
      colorbar: isNarrow()
        ? { orientation: "h", thickness: 12, len: 0.9, x: 0.5, y: 0, yanchor: "bottom" }
        : { thickness: 14, len: 0.8, x: 1, xpad: 4 },
    };
    if (chosen.field === data.fields.length) {
      return Object.assign(mesh, coloured(mesh.colorbar, numbers));
    }
    const field = data.fields[chosen.field];
    const unit = field.unit && " (" + field.unit + ")";
    const title = field.name + " " + field.symbol + unit + (field.beyond && "<br>" + field.beyond);
    mesh.colorbar.title = { text: title, side: isNarrow() ? "top" : "right" };
    return Object.assign(mesh, {
      intensity: of(field.values[chosen.step]), colorscale: "Viridis",
      cmin: field.low, cmax: field.high,
    });
  }
  function coloured(bar, numbers) {
    const shades = ["#e5e7e9"].concat(data.statusColours);
    const scale = [];
    const kinds = shades.length;
    shades.forEach((shade, n) => scale.push([n / kinds, shade], [(n + 1) / kinds, shade]));
    Object.assign(bar, {
      title: { text: "status", side: isNarrow() ? "top" : "right" },
      tickvals: shades.map((_, n) => n - 1), ticktext: ["no contact"].concat(data.statusNames),
    });
    const now = status[chosen.step];
    const median = (n) => {
      const three = axes.map((corner) => now[triangles[n + corner]]);
      return three.sort((a, b) => a - b)[1];
    };
    return {
      intensity: numbers.map(median), intensitymode: "cell", colorscale: scale,
      cmin: -1.5, cmax: kinds - 1.5,
    };
  }
  function sides(x, y, z) {
    const line = { type: "scatter3d", mode: "lines", hoverinfo: "skip", showlegend: false,
      line: { color: "#98a4ac", width: 1.5 }, x: [], y: [], z: [] };
    const before = data.flat
      ? 0.5 * depth(box())
      : 0.003 * Math.hypot(...box().map((range) => range[1] - range[0]));
    [[line.x, x], [line.y, y], [line.z, z]].forEach(([pieces, from], axis) => {
      for (let n = 0; n < ends.length; n++) {
        if (stateOf(partOfPoints[ends[n]]) > 0) continue;
        pieces.push(from[ends[n]] + before * outward[3 * ends[n] + axis]);
        if (n % 2 === 1) pieces.push(null);
      }
    });
    return line;
  }
  // Gaps are magnified as displacements are, or the body would enter the obstacle.
  function rigid() {
    const [x, y, z] = axes.map((n) => moved(n, data.factors[chosen.factor], obstacle[chosen.step]));
    if (!data.flat) {
      const [i, j, k] = axes.map((corner) => column(obstacleTriangles, corner, 3));
      return { type: "mesh3d", x: x, y: y, z: z, i: i, j: j, k: k, color: "#9aa5ad", opacity: 0.35,
        hoverinfo: "skip", flatshading: true, lighting: { ambient: 0.8, diffuse: 0.3 } };
    }
    const line = { type: "scatter3d", mode: "lines", hoverinfo: "skip", showlegend: false,
      line: { color: "#7b868f", width: 5 }, x: [], y: [], z: [] };
    obstacleLines.forEach((at, n) => {
      line.x.push(x[at]);
      line.y.push(y[at]);
      line.z.push(0.7 * depth(box()));
      if (n % 2 === 1) [line.x, line.y, line.z].forEach((pieces) => pieces.push(null));
    });
    return line;
  }
  // Of a plane body the contact is a line, which no triangle shows.
  function marks(x, y) {
    const now = status[chosen.step];
    const shown = data.statusColours.map((colour, kind) => {
      const own = Array.from(now.keys()).filter(
        (n) => now[n] === kind && stateOf(partOfPoints[n]) < 2,
      );
      return { type: "scatter3d", mode: "markers", hoverinfo: "text", showlegend: false,
        text: own.map((n) => words()[n]), marker: { size: 4, color: colour },
        x: own.map((n) => x[n]), y: own.map((n) => y[n]), z: own.map(() => 0.9 * depth(box())) };
    });
    return shown.filter((trace) => trace.x.length > 0);
  }

  function traces() {
    const [x, y, z] = axes.map((axis) => moved(axis, data.factors[chosen.factor]));
    const there = parts.map((_, part) => part).filter((part) => stateOf(part) < 2);
    const found = there.map((part, n) => body(x, y, z, part, n === 0));
    if (chosen.lines === 0 && ends.length > 0) found.push(sides(x, y, z));
    if (data.flat && status && chosen.field === data.fields.length) found.push(...marks(x, y));
    if (obstacle && obstacle[chosen.step] && chosen.obstacle === 0) found.push(rigid());
    return found;
  }
  function axis(name, number) {
    return {
      title: { text: name + (data.unit && " (" + data.unit + ")") },
      showbackground: false, zeroline: false, showspikes: false,
      gridcolor: "rgba(128,128,128,0.25)", visible: !(data.flat && number === 2), tickangle: 0,
      range: box()[number], autorange: false,
    };
  }
  // From far away, two units are seen from top to bottom.
  function scaled() {
    const sizes = box().map((ends) => ends[1] - ends[0]);
    const wide = place.clientWidth / place.clientHeight;
    const scale = data.flat
      ? Math.min((1.5 * wide - (isNarrow() ? 0.1 : 0.3)) / sizes[0], 1.4 / sizes[1])
      : (1.9 * Math.min(1, 0.8 * wide)) / Math.hypot(...sizes);
    return { x: scale * sizes[0], y: scale * sizes[1], z: scale * sizes[2] };
  }
  function layout() {
    const [x, y, z] = data.towards;
    const ink = getComputedStyle(document.body).color;
    const eye = data.flat ? { x: 0, y: 0, z: 2 } : { x: 2 * x, y: 2 * y, z: 2 * z };
    const up = data.flat ? { x: 0, y: 1, z: 0 } : { x: 0, y: 0, z: 1 };
    return {
      margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: "rgba(0,0,0,0)", font: { color: ink },
      modebar: { bgcolor: "rgba(0,0,0,0)", color: ink, activecolor: ink },
      scene: {
        uirevision: chosen.zone, aspectmode: "manual", aspectratio: scaled(),
        dragmode: data.flat ? "pan" : "orbit",
        xaxis: axis("x", 0), yaxis: axis("y", 1), zaxis: axis("z", 2),
        camera: { eye: eye, up: up, projection: { type: "orthographic" } },
      },
    };
  }
  const tools = data.flat ? ["pan3d", "zoom3d"] : ["orbitRotation", "pan3d", "zoom3d"];
  function told() {
    document.querySelectorAll("button[data-group]").forEach((button) => {
      const pressed = chosen[button.dataset.group] === Number(button.dataset.number);
      button.setAttribute("aria-pressed", String(pressed));
    });
    const said = document.querySelector('output[for="view-step"]');
    if (said) said.textContent = "t = " + written(data.times[chosen.step]);
  }
  const options = {
    responsive: true, displaylogo: false,
    modeBarButtons: [["toImage"], tools, ["resetCameraDefault3d"]],
  };
  // While one is drawn another may be asked for, or many, as by a slider: the last one counts.
  let isDrawing = false, isWanted = false;
  async function draw() {
    told();
    isWanted = true;
    if (isDrawing) return;
    isDrawing = true;
    while (isWanted) {
      isWanted = false;
      await Plotly.react(place, traces(), layout(), options);
    }
    isDrawing = false;
    place.dataset.drawn = String(Number(place.dataset.drawn || 0) + 1);
  }
  document.querySelectorAll("button[data-group]").forEach((button) => {
    button.addEventListener("click", () => {
      chosen[button.dataset.group] = Number(button.dataset.number);
      draw();
    });
  });
  const slider = document.getElementById("view-step");
  if (slider) {
    slider.addEventListener("input", () => {
      chosen.step = Number(slider.value);
      draw();
    });
  }
  draw();
})();
