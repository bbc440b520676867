"use strict";
// Draws answers: of flat models on canvases, which follow fastest; what is in space by plotly.
window.exploreDrawing = function (data) {
  const STATUS = ["open", "stick", "slip"];
  const MAPS = [
    ["status", "status", ""], ["pressure", "contact pressure", "stress"],
    ["friction", "friction traction", "stress"], ["slip", "slip", "length"], ["gap", "gap", "length"],
  ];
  const VIRIDIS = ["#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779",
    "#6ece58", "#b5de2b", "#fde725"];
  const GREY = "rgba(128,128,128,0.25)", OBSTACLE = "#7b868f";
  const PRESSURE = "#3b78b8", FRICTION = "#e07b00";
  const options = { responsive: true, displaylogo: false, displayModeBar: false };

  function unit(measured) {
    return data.units[measured] ? " (" + data.units[measured] + ")" : "";
  }
  function ink() { return getComputedStyle(document.body).color; }
  function column(from, axis, width) {
    const found = new from.constructor(from.length / width);
    for (let n = 0; n < found.length; n++) found[n] = from[width * n + axis];
    return found;
  }
  function ends(list, low = Infinity, high = -Infinity) {
    for (let n = 0; n < list.length; n++) {
      if (Number.isFinite(list[n])) { low = Math.min(low, list[n]); high = Math.max(high, list[n]); }
    }
    return [low, high];
  }
  // A range that stays while one drags, unless what is shown leaves it or gets small in it.
  function steady(ranges, name, [low, high]) {
    const old = ranges[name], size = Math.max(high - low, 1e-30);
    if (!old || low < old[0] || high > old[1] || size < 0.35 * (old[1] - old[0])) {
      ranges[name] = [low - 0.08 * size, high + 0.2 * size];
    }
    return ranges[name];
  }

  // ---------------------------------------------------------------- the body
  // What is shown of it, axis by axis.
  function boxOf(shape, answer, chosen) {
    const zone = answer.arrays[chosen.contact + ".zone"];
    if (chosen.zone && zone) return [0, 1, 2].map((axis) => [zone[axis], zone[3 + axis]]);
    if (!shape.box) {
      shape.box = [0, 1, 2].map((axis) => {
        const [low, high] = ends(column(shape.arrays.points, axis, 3));
        return [low - 0.05 * shape.size, high + 0.05 * shape.size];
      });
    }
    return shape.box;
  }
  function movedBy(places, offsets, factor) {
    const found = new Float32Array(places.length);
    for (let n = 0; n < places.length; n++) found[n] = places[n] + factor * offsets[n];
    return found;
  }
  function sizes(vectors) {
    const found = new Float32Array(vectors.length / 3);
    for (let n = 0; n < found.length; n++) {
      found[n] = Math.hypot(vectors[3 * n], vectors[3 * n + 1], vectors[3 * n + 2]);
    }
    return found;
  }
  function body(shape, answer, moved, obstacles, chosen, factor) {
    const box = boxOf(shape, answer, chosen), now = chosen.magnified ? factor : 1;
    const draw = shape.dimension === 2 ? flat : solid;
    document.getElementById("flat").hidden = shape.dimension !== 2;
    return draw(shape, moved, obstacles, box, now, chosen);
  }
  function ticks(low, high, count) {
    const rough = (high - low) / Math.max(count, 2), power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((one) => one * power >= rough);
    const found = [];
    for (let n = Math.ceil(low / step); n * step <= high; n++) found.push(Number((n * step).toPrecision(12)));
    return found;
  }
  // A canvas as large as its place, and what draws on it.
  function sheet(id) {
    const canvas = document.getElementById(id), place = canvas.parentElement;
    const [wide, high] = [place.clientWidth, place.clientHeight], ratio = window.devicePixelRatio || 1;
    if (canvas.width !== Math.round(wide * ratio) || canvas.height !== Math.round(high * ratio)) {
      [canvas.width, canvas.height] = [Math.round(wide * ratio), Math.round(high * ratio)];
    }
    // by the processor: sent through a graphics driver, small pieces wait for it
    const pen = canvas.getContext("2d", { willReadFrequently: true });
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, wide, high);
    pen.font = "12px system-ui, sans-serif";
    pen.lineJoin = "round";
    return { pen, wide, high };
  }
  // Grid, numbers and titles of a panel; what takes numbers to pixels.
  function frame(pen, [left, top, width, height], [x0, x1], [y0, y1], titles) {
    const X = (x) => left + (width * (x - x0)) / (x1 - x0);
    const Y = (y) => top + (height * (y1 - y)) / (y1 - y0);
    pen.strokeStyle = GREY;
    pen.fillStyle = ink();
    pen.lineWidth = 1;
    pen.beginPath();
    pen.textAlign = "center";
    ticks(x0, x1, 6).forEach((x) => {
      pen.moveTo(X(x), top);
      pen.lineTo(X(x), top + height);
      if (titles[0]) pen.fillText(written(x), X(x), top + height + 16);
    });
    pen.fillText(titles[0], left + width / 2, top + height + 34);
    pen.textAlign = "right";
    ticks(y0, y1, height / 32).forEach((y) => {
      pen.moveTo(left, Y(y));
      pen.lineTo(left + width, Y(y));
      pen.fillText(written(y), left - 6, Y(y) + 4);
    });
    pen.stroke();
    pen.save();
    pen.translate(13, top + height / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillText(titles[1], 0, 0);
    pen.restore();
    return [X, Y];
  }
  function written(value) {
    const plain = Number(value.toPrecision(6));
    return plain !== 0 && (Math.abs(plain) < 1e-4 || Math.abs(plain) >= 1e6) ? plain.toExponential() : String(plain);
  }
  function clipped(pen, [left, top, width, height], draw) {
    pen.save();
    pen.beginPath();
    pen.rect(left, top, width, height);
    pen.clip();
    draw();
    pen.restore();
  }
  function flat(shape, moved, obstacles, box, now) {
    const { pen, wide, high } = sheet("flat");
    const panel = [66, 10, wide - 162, high - 52], [left, top, width, height] = panel;
    const scale = Math.min(width / (box[0][1] - box[0][0]), height / (box[1][1] - box[1][0]));
    const spans = [width, height].map((pixels, axis) => {
      const middle = (box[axis][0] + box[axis][1]) / 2;
      return [middle - pixels / scale / 2, middle + pixels / scale / 2];
    });
    const [X, Y] = frame(pen, panel, ...spans, ["x" + unit("length"), "y" + unit("length")]);
    const places = movedBy(shape.arrays.points, moved, now), size = sizes(moved);
    const count = size.length, px = new Float32Array(count), py = new Float32Array(count);
    for (let n = 0; n < count; n++) { px[n] = X(places[3 * n]); py[n] = Y(places[3 * n + 1]); }
    const most = Math.max(ends(size)[1], 1e-300), lines = shape.arrays.lines;
    clipped(pen, panel, () => {
      paint(pen, shape.arrays.triangles, px, py, size, most, wide, high);
      if (scale * shape.size > 6 * Math.sqrt(lines.length)) mesh(pen, lines, px, py);
      pen.strokeStyle = OBSTACLE;
      pen.lineWidth = 3;
      shape.contacts.forEach((contact, n) => obstacle(pen, contact, obstacles[n], now, X, Y));
    });
    bar(pen, left + width + 24, top + 10, height - 20, most);
  }
  function mesh(pen, lines, px, py) {
    pen.beginPath();
    for (let n = 0; n < lines.length; n += 2) {
      pen.moveTo(px[lines[n]], py[lines[n]]);
      pen.lineTo(px[lines[n + 1]], py[lines[n + 1]]);
    }
    pen.strokeStyle = "rgba(255,255,255,0.22)";
    pen.stroke();
  }
  // Triangles of about one colour are filled together.
  function paint(pen, triangles, px, py, size, most, wide, high) {
    const levels = 40, paths = Array.from({ length: levels }, () => new Path2D());
    for (let n = 0; n < triangles.length; n += 3) {
      const [a, b, c] = [triangles[n], triangles[n + 1], triangles[n + 2]];
      if (Math.max(px[a], px[b], px[c]) < 0 || Math.min(px[a], px[b], px[c]) > wide) continue;
      if (Math.max(py[a], py[b], py[c]) < 0 || Math.min(py[a], py[b], py[c]) > high) continue;
      const share = (size[a] + size[b] + size[c]) / (3 * most);
      const path = paths[Math.min(levels - 1, Math.floor(share * levels))];
      path.moveTo(px[a], py[a]);
      path.lineTo(px[b], py[b]);
      path.lineTo(px[c], py[c]);
      path.closePath();
    }
    pen.lineWidth = 0.8; // over the seams
    paths.forEach((path, level) => {
      pen.fillStyle = pen.strokeStyle = shade((level + 0.5) / levels);
      pen.fill(path);
      pen.stroke(path);
    });
    pen.lineWidth = 1;
  }
  function shade(share) {
    const at = share * (VIRIDIS.length - 1), n = Math.min(VIRIDIS.length - 2, Math.floor(at));
    const part = (colour, m) => parseInt(colour.slice(2 * m + 1, 2 * m + 3), 16);
    const mixed = [0, 1, 2].map((m) =>
      Math.round(part(VIRIDIS[n], m) + (at - n) * (part(VIRIDIS[n + 1], m) - part(VIRIDIS[n], m))));
    return "rgb(" + mixed.join(",") + ")";
  }
  function obstacle(pen, contact, offsets, now, X, Y) {
    if (!offsets) return;
    const places = movedBy(contact.places, offsets, now);
    pen.beginPath();
    let isOn = false;
    for (let n = 0; n < places.length / 3; n++) {
      const [x, y] = [X(places[3 * n]), Y(places[3 * n + 1])];
      if (!Number.isFinite(x + y)) continue;
      if (isOn) pen.lineTo(x, y);
      else pen.moveTo(x, y);
      isOn = !contact.breaks.has(n);
    }
    pen.stroke();
  }
  function bar(pen, left, top, height, most) {
    const colours = pen.createLinearGradient(0, top + height, 0, top);
    VIRIDIS.forEach((colour, n) => colours.addColorStop(n / (VIRIDIS.length - 1), colour));
    pen.fillStyle = colours;
    pen.fillRect(left, top, 12, height);
    pen.fillStyle = ink();
    pen.textAlign = "left";
    ticks(0, most, 5).forEach((value) => pen.fillText(written(value), left + 17, top + height * (1 - value / most) + 4));
    pen.fillText("|u|" + unit("length"), left - 4, top + height + 24);
  }
  function solid(shape, moved, obstacles, box, now, chosen) {
    const { triangles, lines } = shape.arrays;
    const places = movedBy(shape.arrays.points, moved, now);
    const [x, y, z] = [0, 1, 2].map((axis) => column(places, axis, 3));
    const sides = { x: [], y: [], z: [] };
    for (let n = 0; n < lines.length; n += 2) {
      sides.x.push(x[lines[n]], x[lines[n + 1]], null);
      sides.y.push(y[lines[n]], y[lines[n + 1]], null);
      sides.z.push(z[lines[n]], z[lines[n + 1]], null);
    }
    const traces = [
      {
        type: "mesh3d", x, y, z, ...corners(triangles), intensity: sizes(moved), cmin: 0,
        colorscale: "Viridis", hoverinfo: "skip",
        lighting: { ambient: 0.7, diffuse: 0.5, specular: 0.05 },
        colorbar: { title: { text: "|u|" + unit("length"), side: "right" }, thickness: 12, len: 0.8 },
      },
      { type: "scatter3d", mode: "lines", hoverinfo: "skip", showlegend: false, ...sides,
        line: { color: "rgba(120,135,145,0.6)", width: 1 } },
      ...shape.contacts.map((contact, n) => {
        const stands = obstacles[n] ? movedBy(contact.places, obstacles[n], now) : new Float32Array(0);
        return { type: "mesh3d", hoverinfo: "skip", color: "#9aa5ad", opacity: 0.35, flatshading: true,
          showscale: false, x: column(stands, 0, 3), y: column(stands, 1, 3), z: column(stands, 2, 3),
          ...corners(stands.length ? contact.pieces : new Int32Array(0)) };
      }),
    ];
    const layout = sceneLayout("body", box, false, "zone " + chosen.zone + chosen.contact);
    return Plotly.react("body", traces, layout, options);
  }
  function corners(triangles) {
    const [i, j, k] = [0, 1, 2].map((corner) => column(triangles, corner, 3));
    return { i, j, k };
  }
  // From far away, two units are seen from top to bottom.
  function sceneLayout(id, box, isFlat, revision) {
    const place = document.getElementById(id), wide = place.clientWidth / place.clientHeight;
    const spans = box.map(([low, high]) => Math.max(high - low, 1e-30));
    const scale = isFlat
      ? Math.min((1.5 * wide - 0.3) / spans[0], 1.4 / spans[1])
      : (1.9 * Math.min(1, 0.8 * wide)) / Math.hypot(...spans);
    const axis = (title, n) => ({
      title: { text: title }, range: box[n], autorange: false, showbackground: false, zeroline: false,
      showspikes: false, gridcolor: GREY, tickangle: 0, visible: !(isFlat && n === 2), nticks: 6,
    });
    return {
      margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: "rgba(0,0,0,0)", font: { color: ink() },
      scene: {
        uirevision: revision, aspectmode: "manual", dragmode: isFlat ? "pan" : "orbit",
        aspectratio: { x: scale * spans[0], y: scale * spans[1], z: scale * spans[2] },
        camera: {
          eye: isFlat ? { x: 0, y: 0, z: 2 } : { x: 1.1, y: -1.4, z: 0.9 },
          up: isFlat ? { x: 0, y: 1, z: 0 } : { x: 0, y: 0, z: 1 },
          projection: { type: "orthographic" },
        },
        xaxis: axis("x" + unit("length"), 0), yaxis: axis("y" + unit("length"), 1),
        zaxis: axis("z" + unit("length"), 2),
      },
    };
  }

  // ---------------------------------------------------------------- the contact
  function contact(shape, answer, chosen) {
    const one = shape.contacts[chosen.contact];
    const of = (name) => answer.arrays[chosen.contact + "." + name];
    document.getElementById("curves").hidden = shape.dimension !== 2;
    return shape.dimension === 2 ? curves(one, of) : map(one, of, chosen.map);
  }
  // Along the line, from where it touches as far again to both sides.
  function alongRange(one, status) {
    const [first, last] = [one.at[0], one.at[one.at.length - 1]];
    let [low, high] = ends(one.at.filter((_, n) => status[n] > 0));
    if (!(high > low)) [low, high] = [first, last];
    const old = one.ranges.along, size = high - low;
    if (!old || low < old[0] || high > old[1] || size < 0.3 * (old[1] - old[0])) {
      const found = [Math.max(first, low - 0.45 * size), Math.min(last, high + 0.45 * size)];
      const room = 0.02 * (found[1] - found[0]);
      one.ranges.along = [found[0] - room, found[1] + room];
    }
    return one.ranges.along;
  }
  function curves(one, of) {
    const [status, pressure, friction, slip, gap] = ["status", "pressure", "friction", "slip", "gap"].map(of);
    const along = alongRange(one, status), isRough = friction.some((value) => value !== 0);
    const shown = [];
    one.at.forEach((at, n) => { if (at >= along[0] && at <= along[1]) shown.push(n); });
    const { pen, wide, high } = sheet("curves");
    const width = wide - 82, room = high - 34 - 52, legend = [["contact pressure", PRESSURE]];
    if (isRough) legend.push(["friction traction", FRICTION]);
    const panels = [
      ["stress", "stress", 0, 0.5, [[pressure, PRESSURE], ...(isRough ? [[friction, FRICTION]] : [])]],
      ["slip", "length", 0.56, 0.74, [[slip, "#9e4f96"]]],
      ["gap", "length", 0.81, 1, [[gap, "#1b7f5c"]]],
    ];
    panels.forEach(([name, measured, from, to, series], number) => {
      const panel = [70, 34 + room * from, width, room * (to - from)];
      const values = series.flatMap(([list]) => shown.map((n) => list[n]));
      const range = steady(one.ranges, name, ends(values, 0, 0));
      const titles = [number === 2 ? one.axes[0] + unit("length") : "", name + unit(measured)];
      const [X, Y] = frame(pen, panel, along, range, titles);
      clipped(pen, panel, () => {
        series.forEach(([list, colour]) => line(pen, one, shown, list, colour, X, Y));
        if (number === 0) marks(pen, one, shown, status, pressure, X, Y);
      });
    });
    const kinds = isRough ? [["stick", 1], ["slip", 2], ["open", 0]] : [["in contact", 1], ["open", 0]];
    keyOf(pen, [...legend, ...kinds.map(([words, kind]) => [words, data.colours[kind], kind])]);
  }
  function line(pen, one, shown, list, colour, X, Y) {
    pen.beginPath();
    let isOn = false;
    shown.forEach((n) => {
      if (!Number.isFinite(list[n])) { isOn = false; return; }
      if (isOn) pen.lineTo(X(one.at[n]), Y(list[n]));
      else pen.moveTo(X(one.at[n]), Y(list[n]));
      isOn = !one.breaks.has(n);
    });
    pen.strokeStyle = colour;
    pen.lineWidth = 2;
    pen.stroke();
  }
  function marks(pen, one, shown, status, pressure, X, Y) {
    shown.forEach((n) => mark(pen, status[n], data.colours[status[n]], X(one.at[n]), Y(pressure[n])));
  }
  // Slip is a square, what else there is a disc.
  function mark(pen, kind, colour, x, y) {
    pen.beginPath();
    if (kind === 2) pen.rect(x - 3, y - 3, 6, 6);
    else pen.arc(x, y, 3, 0, 2 * Math.PI);
    pen.fillStyle = colour;
    pen.fill();
    pen.strokeStyle = "rgba(255,255,255,0.8)";
    pen.lineWidth = 0.7;
    pen.stroke();
  }
  function keyOf(pen, entries) {
    let x = 74;
    pen.textAlign = "left";
    entries.forEach(([words, colour, kind]) => {
      pen.strokeStyle = pen.fillStyle = colour;
      if (kind === undefined) pen.fillRect(x, 12, 18, 3);
      else mark(pen, kind, colour, x + 9, 13);
      pen.fillStyle = ink();
      pen.fillText(words, x + 24, 18);
      x += 40 + pen.measureText(words).width;
    });
  }
  function map(one, of, name) {
    const [, words, measured] = MAPS.find(([each]) => each === name);
    const values = of(name), x = column(one.at, 0, 2), y = column(one.at, 1, 2);
    const spans = [ends(x), ends(y)], room = 0.05 * Math.max(...spans.map(([low, high]) => high - low));
    const box = [...spans.map(([low, high]) => [low - room, high + room]), [-room, room]];
    const trace = {
      type: "mesh3d", x, y, z: new Float32Array(x.length), ...corners(one.pieces), hoverinfo: "skip",
      lighting: { ambient: 1, diffuse: 0, specular: 0 },
      colorbar: { title: { text: words + (measured ? unit(measured) : ""), side: "right" }, thickness: 12, len: 0.8 },
    };
    if (name === "status") {
      const { i, j, k } = trace;
      const median = (n) => [values[i[n]], values[j[n]], values[k[n]]].sort((a, b) => a - b)[1];
      Object.assign(trace, {
        intensity: Array.from(i.keys(), median), intensitymode: "cell", cmin: -0.5, cmax: 2.5,
        colorscale: data.colours.flatMap((colour, n) => [[n / 3, colour], [(n + 1) / 3, colour]]),
      });
      Object.assign(trace.colorbar, { tickvals: [0, 1, 2], ticktext: STATUS });
    } else {
      const [low, high] = steady(one.ranges, name, ends(values, 0, 0));
      Object.assign(trace, { intensity: values, intensitymode: "vertex", colorscale: "Viridis",
        cmin: name === "gap" ? low : 0, cmax: high });
    }
    const layout = sceneLayout("contact", box, true, "map");
    layout.scene.xaxis.title.text = one.axes[0] + unit("length");
    layout.scene.yaxis.title.text = one.axes[1] + unit("length");
    return Plotly.react("contact", [trace], layout, options);
  }
  function clear() {
    ["body", "contact"].forEach((id) => { if (document.getElementById(id).data) Plotly.purge(id); });
  }
  return { body, contact, clear, maps: MAPS.map(([name, words]) => [name, words]) };
};
