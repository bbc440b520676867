"use strict";
(function () {
  const data = JSON.parse(document.getElementById("explore-data").textContent);
  const $ = (id) => document.getElementById(id);
  const STATUS = ["open", "stick", "slip"];
  const MAPS = [
    ["status", "status", ""], ["pressure", "contact pressure", "stress"],
    ["friction", "friction traction", "stress"], ["slip", "slip", "length"], ["gap", "gap", "length"],
  ];
  const values = {};
  Object.entries(data.keys).forEach(([key, one]) => { values[key] = one.start; });
  let shape = null, answer = null, bodyNow = null, obstacleNow = {}, factor = 1;
  const chosen = { contact: 0, map: "pressure", magnified: true, zone: false };
  document.body.dataset.drawn = "0";

  // ---------------------------------------------------------------- messages
  function decoded(buffer) {
    const length = new DataView(buffer).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    let at = 4 + length;
    const found = {};
    head.arrays.forEach(([name, letter, size]) => {
      found[name] = new (letter === "f" ? Float32Array : Int32Array)(buffer, at, size);
      at += 4 * size;
    });
    head.arrays = found;
    return head;
  }
  const socket = new WebSocket(location.href.replace(/^http/, "ws").replace(/#.*$/, "") + "messages");
  socket.binaryType = "arraybuffer";
  let number = 0, asked = null, wants = false;
  // Of what is dragged one request is on its way, and the latest waits for its answer.
  function ask(kind) {
    if (socket.readyState !== WebSocket.OPEN) return;
    if (kind === "follow" && asked && asked.kind === "follow") { wants = true; return; }
    wants = false;
    number += 1;
    if (kind !== "scene") asked = { kind, number };
    socket.send(JSON.stringify({ number, kind, values }));
  }
  const begun = performance.now();
  socket.onopen = () => ask("follow");
  socket.onclose = () => {
    if (document.body.dataset.ended) return;
    document.body.dataset.ended = "true";
    tell("bad", "The program has ended", ["Start it again to go on; what is shown is its last answer."]);
  };
  socket.onmessage = (event) => {
    const found = decoded(event.data);
    if (found.kind === "progress") { tell("", "Making ready", found.said); return; }
    if (found.kind === "shape") { takeShape(found); return; }
    if (found.kind === "scene") { copy(found.said[0]); return; }
    if (found.kind === "ended") {
      document.body.dataset.ended = "true";
      tell("bad", "The program has ended", found.said);
      return;
    }
    if (asked && found.number === asked.number) asked = null;
    if (wants) ask("follow");
    if (found.kind === "answer") takeAnswer(found);
    else tell("bad", answer ? "No answer: the last one is shown" : "No answer", found.said);
    document.body.dataset.answered = String(found.number);
  };
  function tell(kind, outcome, sentences) {
    $("state").className = "verdict " + kind;
    $("outcome").textContent = outcome;
    $("said").replaceChildren(...sentences.map((text) => {
      const item = document.createElement("li");
      item.textContent = text;
      return item;
    }));
  }

  // ---------------------------------------------------------------- what is moved
  function rounded(key, value) {
    const { low, high, whole } = data.keys[key];
    if (whole) return Math.round(value);
    const digits = Math.max(0, Math.min(100, 3 - Math.floor(Math.log10(high - low))));
    return Math.min(high, Math.max(low, Number(value.toFixed(digits))));
  }
  function inputs(key) {
    return document.querySelectorAll('input[data-key="' + CSS.escape(key) + '"]');
  }
  function show(key) {
    inputs(key).forEach((input) => {
      if (input !== document.activeElement || input.type === "range") input.value = values[key];
    });
  }
  function moved(input, isLast) {
    const key = input.dataset.key, one = data.keys[key];
    const isSlider = input.type === "range";
    const value = isSlider ? rounded(key, Number(input.value)) : input.valueAsNumber;
    if (!Number.isFinite(value) || value < one.low || value > one.high) return;
    if (!isSlider && !input.checkValidity()) return;
    values[key] = value;
    inputs(key).forEach((other) => { if (other !== input) other.value = value; });
    if (isLast) ask("solve");
    else if (!one.anew) ask("follow");
  }
  document.querySelectorAll("input[data-key]").forEach((input) => {
    input.addEventListener("input", () => moved(input, false));
    input.addEventListener("change", () => moved(input, true));
  });
  $("back").addEventListener("click", () => {
    Object.entries(data.keys).forEach(([key, one]) => { values[key] = one.start; show(key); });
    ask("solve");
  });
  $("copy").addEventListener("click", () => ask("scene"));
  async function copy(text) {
    $("copied").hidden = false;
    $("scene").value = text;
    try {
      await navigator.clipboard.writeText(text);
      $("copied-said").textContent = "Copied. It is for a file beside the scene that you explore.";
    } catch (error) {
      $("scene").select();
      $("copied-said").textContent = "Copy this into a file beside the scene that you explore.";
    }
  }

  // ---------------------------------------------------------------- what comes out
  function takeShape(found) {
    shape = found;
    shape.contacts.forEach((contact, n) => {
      contact.at = found.arrays[n + ".at"];
      contact.places = found.arrays[n + ".places"];
      contact.pieces = found.arrays[n + ".pieces"];
      contact.breaks = new Set(found.arrays[n + ".breaks"]);
      contact.ranges = {};
    });
    bodyNow = null;
    obstacleNow = {};
    chosen.contact = Math.min(chosen.contact, Math.max(shape.contacts.length - 1, 0));
    buttons("contacts", shape.contacts.map((c, n) => [n, c.name]), "contact");
    $("contacts").hidden = shape.contacts.length < 2;
    $("contact").hidden = shape.contacts.length === 0;
    buttons("shown", MAPS.map(([name, words]) => [name, words]), "map");
    $("shown").hidden = shape.dimension === 2 || shape.contacts.length === 0;
    Plotly.purge("body");
    Plotly.purge("contact");
  }
  function takeAnswer(found) {
    answer = found;
    if (found.arrays.displacement) {
      bodyNow = found.arrays.displacement;
      shape.contacts.forEach((_, n) => { obstacleNow[n] = found.arrays[n + ".obstacle"]; });
      if (found.whole || !document.body.dataset.ready) factor = readable();
    }
    tableOf(found);
    if (found.whole) tell(found.passed ? "ok" : "bad", found.passed ? "✓ OK" : "✗ Not to be trusted", found.said);
    else tell("", found.start === "followed" ? "Followed from the last answer" : "Quick answer", found.said);
    draw();
    if (!document.body.dataset.ready) {
      document.body.dataset.ready = String(Math.round(performance.now()));
      ask("solve");
    }
  }
  function tableOf(found) {
    const table = $("quantities");
    table.className = found.whole ? "" : "stale";
    table.tBodies[0].replaceChildren(...found.rows.map(([name, value, bar, unit]) => {
      const row = document.createElement("tr");
      const head = document.createElement("th");
      head.scope = "row";
      head.textContent = name;
      row.append(head);
      [unit ? value + " " + unit : value, bar].forEach((text) => {
        const cell = document.createElement("td");
        cell.textContent = text;
        row.append(cell);
      });
      row.dataset.name = name;
      return row;
    }));
  }
  // 1, or 1, 2 or 5 times a power of ten by which the largest displacement is seen.
  function readable() {
    const size = shape.size;
    let largest = 0;
    for (let n = 0; n < bodyNow.length; n += 3) {
      largest = Math.max(largest, Math.hypot(bodyNow[n], bodyNow[n + 1], bodyNow[n + 2]));
    }
    if (largest === 0 || largest > 0.02 * (chosen.zone ? zoneSize() : size)) return 1;
    const wanted = (0.06 * size) / largest, power = 10 ** Math.floor(Math.log10(wanted));
    return power * [5, 2, 1].find((step) => step * power <= wanted * 1.000001);
  }
  function zoneSize() {
    const zone = answer.arrays[chosen.contact + ".zone"];
    return zone ? Math.hypot(zone[3] - zone[0], zone[4] - zone[1], zone[5] - zone[2]) : shape.size;
  }

  // ---------------------------------------------------------------- drawing
  let isDrawing = false, isWanted = false;
  function draw() {
    isWanted = true;
    if (isDrawing) return;
    isDrawing = true;
    requestAnimationFrame(async () => {
      while (isWanted) {
        isWanted = false;
        labels();
        if (shape.contacts.length) await (shape.dimension === 2 ? drawCurves() : drawMap());
        if (bodyNow) await drawBody();
        document.body.dataset.drawn = String(Number(document.body.dataset.drawn) + 1);
        document.body.dataset.shown = String(answer.number);
      }
      isDrawing = false;
    });
  }
  function unit(measured) {
    return data.units[measured] ? " (" + data.units[measured] + ")" : "";
  }
  function ink() { return getComputedStyle(document.body).color; }
  function column(from, axis, width) {
    const found = new from.constructor(from.length / width);
    for (let n = 0; n < found.length; n++) found[n] = from[width * n + axis];
    return found;
  }
  const options = { responsive: true, displaylogo: false, displayModeBar: false };
  function sceneLayout(box, isFlat, revision) {
    const sizes = box.map(([low, high]) => Math.max(high - low, 1e-30));
    const wide = isFlat ? Math.max(sizes[0] / 1.9, sizes[1]) : Math.max(...sizes);
    const scale = (isFlat ? 1.25 : 1.3) / wide;
    const axis = (title, n) => ({
      title: { text: title }, range: box[n], autorange: false, showbackground: false,
      zeroline: false, showspikes: false, gridcolor: "rgba(128,128,128,0.25)", tickangle: 0,
      visible: !(isFlat && n === 2), nticks: 6,
    });
    return {
      margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: "rgba(0,0,0,0)", font: { color: ink() },
      uirevision: revision,
      scene: {
        uirevision: revision, aspectmode: "manual", dragmode: isFlat ? "pan" : "orbit",
        aspectratio: { x: scale * sizes[0], y: scale * sizes[1], z: scale * sizes[2] },
        camera: {
          eye: isFlat ? { x: 0, y: 0, z: 2 } : { x: 1.1, y: -1.4, z: 0.9 },
          up: isFlat ? { x: 0, y: 1, z: 0 } : { x: 0, y: 0, z: 1 },
          projection: { type: "orthographic" },
        },
        xaxis: axis(isFlat ? "x" + unit("length") : "x", 0),
        yaxis: axis(isFlat ? "y" + unit("length") : "y", 1), zaxis: axis("z", 2),
      },
    };
  }
  function bodyBox() {
    const zone = answer.arrays[chosen.contact + ".zone"];
    let box;
    if (chosen.zone && zone) {
      box = [0, 1, 2].map((axis) => [zone[axis], zone[3 + axis]]);
    } else {
      box = [0, 1, 2].map((axis) => {
        const all = column(shape.arrays.points, axis, 3);
        let low = Infinity, high = -Infinity;
        all.forEach((x) => { low = Math.min(low, x); high = Math.max(high, x); });
        const room = 0.06 * shape.size;
        return [low - room, high + room];
      });
    }
    if (shape.dimension === 2) box[2] = [-1, 1].map((end) => end * 0.02 * (box[0][1] - box[0][0]));
    return box;
  }
  function drawBody() {
    const { points, triangles, lines } = shape.arrays;
    const now = chosen.magnified ? factor : 1, box = bodyBox(), isFlat = shape.dimension === 2;
    const count = points.length / 3;
    const [x, y, z] = [0, 1, 2].map((axis) => {
      const found = new Float32Array(count);
      for (let n = 0; n < count; n++) found[n] = points[3 * n + axis] + now * bodyNow[3 * n + axis];
      return found;
    });
    const size = new Float32Array(count);
    for (let n = 0; n < count; n++) {
      size[n] = Math.hypot(bodyNow[3 * n], bodyNow[3 * n + 1], bodyNow[3 * n + 2]);
    }
    const before = isFlat ? 0.5 * box[2][1] : 0;
    const ends = { x: [], y: [], z: [] };
    for (let n = 0; n < lines.length; n += 2) {
      const [a, b] = [lines[n], lines[n + 1]];
      ends.x.push(x[a], x[b], null);
      ends.y.push(y[a], y[b], null);
      ends.z.push(z[a] + before, z[b] + before, null);
    }
    const traces = [
      {
        type: "mesh3d", x, y, z, i: column(triangles, 0, 3), j: column(triangles, 1, 3),
        k: column(triangles, 2, 3), intensity: size, colorscale: "Viridis", cmin: 0,
        flatshading: false, hoverinfo: "skip",
        lighting: isFlat ? { ambient: 1, diffuse: 0, specular: 0 } : { ambient: 0.7, diffuse: 0.5, specular: 0.05 },
        colorbar: { title: { text: "|u|" + unit("length"), side: "right" }, thickness: 12, len: 0.8 },
      },
      { type: "scatter3d", mode: "lines", hoverinfo: "skip", showlegend: false,
        line: { color: "rgba(120,135,145,0.6)", width: 1 }, ...ends },
    ];
    shape.contacts.forEach((contact, n) => traces.push(rigid(contact, obstacleNow[n], now, before, isFlat)));
    return Plotly.react("body", traces, sceneLayout(box, isFlat, "zone " + chosen.zone + chosen.contact), options);
  }
  function rigid(contact, offsets, now, before, isFlat) {
    const count = offsets ? contact.places.length / 3 : 0;
    const [x, y, z] = [0, 1, 2].map((axis) => {
      const found = new Float32Array(count);
      for (let n = 0; n < count; n++) {
        found[n] = contact.places[3 * n + axis] + now * offsets[3 * n + axis];
      }
      return found;
    });
    if (isFlat) {
      const line = { x: [], y: [], z: [] };
      for (let n = 0; n < count; n++) {
        line.x.push(x[n]);
        line.y.push(y[n]);
        line.z.push(2 * before * 0.9);
        if (contact.breaks.has(n)) [line.x, line.y, line.z].forEach((piece) => piece.push(null));
      }
      return { type: "scatter3d", mode: "lines", hoverinfo: "skip", showlegend: false,
        line: { color: "#7b868f", width: 5 }, ...line };
    }
    const pieces = count ? contact.pieces : new Int32Array(0);
    return { type: "mesh3d", x, y, z, i: column(pieces, 0, 3), j: column(pieces, 1, 3),
      k: column(pieces, 2, 3), color: "#9aa5ad", opacity: 0.35, hoverinfo: "skip", flatshading: true,
      showscale: false };
  }
  // A range that stays while one drags, unless what is shown leaves it or gets small in it.
  function steady(ranges, name, low, high) {
    const old = ranges[name], size = Math.max(high - low, 1e-30);
    if (!old || low < old[0] || high > old[1] || size < 0.35 * (old[1] - old[0])) {
      ranges[name] = [low - 0.08 * size, high + 0.2 * size];
    }
    return ranges[name];
  }
  function extent(list) {
    let low = 0, high = 0;
    list.forEach((x) => { if (Number.isFinite(x)) { low = Math.min(low, x); high = Math.max(high, x); } });
    return [low, high];
  }
  function alongRange(contact, status) {
    const at = contact.at;
    let low = Infinity, high = -Infinity;
    at.forEach((x, n) => { if (status[n] > 0) { low = Math.min(low, x); high = Math.max(high, x); } });
    const [first, last] = [at[0], at[at.length - 1]];
    if (!(high > low)) [low, high] = [first, last];
    const old = contact.ranges.along, size = high - low;
    if (!old || low < old[0] || high > old[1] || size < 0.3 * (old[1] - old[0])) {
      contact.ranges.along = [Math.max(first, low - 0.45 * size), Math.min(last, high + 0.45 * size)];
      const room = 0.02 * (contact.ranges.along[1] - contact.ranges.along[0]);
      contact.ranges.along = [contact.ranges.along[0] - room, contact.ranges.along[1] + room];
    }
    return contact.ranges.along;
  }
  function drawCurves() {
    const n = chosen.contact, contact = shape.contacts[n];
    const of = (name) => answer.arrays[n + "." + name];
    const status = of("status"), along = alongRange(contact, status);
    const [pressure, friction, slip, gap] = ["pressure", "friction", "slip", "gap"].map(of);
    const broken = (list) => {
      const found = [];
      list.forEach((value, m) => {
        found.push(Number.isFinite(value) ? value : null);
        if (contact.breaks.has(m)) found.push(null);
      });
      return found;
    };
    const x = broken(contact.at);
    const inView = (list) => list.filter((_, m) => contact.at[m] >= along[0] && contact.at[m] <= along[1]);
    const line = (name, list, axis, colour, dash) => ({
      type: "scatter", mode: "lines", x, y: broken(list), name, xaxis: "x", yaxis: axis,
      line: { color: colour, width: 2, dash }, hoverinfo: "x+y",
    });
    const dark = "#3b78b8";
    const hasFriction = friction.some((value) => value !== 0);
    const traces = [
      line("contact pressure", pressure, "y", dark, "solid"),
      line("friction traction", hasFriction ? friction : [], "y", "#e07b00", "solid"),
      line("slip", slip, "y2", "#9e4f96", "solid"),
      line("gap", gap, "y3", "#1b7f5c", "solid"),
    ];
    const own = (kind) => Array.from(status.keys()).filter((m) => status[m] === kind);
    (hasFriction ? [1, 2, 0] : [-1, 0]).forEach((kind) => {
      const there = kind < 0 ? Array.from(status.keys()).filter((m) => status[m] > 0) : own(kind);
      traces.push({
        type: "scatter", mode: "markers", x: there.map((m) => contact.at[m]),
        y: there.map((m) => pressure[m]), name: kind < 0 ? "in contact" : STATUS[kind], yaxis: "y", xaxis: "x",
        marker: {
          color: data.colours[kind < 0 ? 1 : kind], size: 6, symbol: kind === 2 ? "square" : "circle",
          line: { color: "#ffffff", width: 0.7 },
        },
        hoverinfo: "x+y+name",
      });
    });
    const stresses = extent([...inView(pressure), ...(hasFriction ? inView(friction) : [])]);
    const axis = (title, domain, range) => ({
      title: { text: title }, domain, range, zerolinecolor: "rgba(128,128,128,0.6)",
      gridcolor: "rgba(128,128,128,0.2)", nticks: 5, exponentformat: "power", automargin: false,
    });
    const layout = {
      margin: { l: 74, r: 12, t: 8, b: 44 }, paper_bgcolor: "rgba(0,0,0,0)",
      plot_bgcolor: "rgba(0,0,0,0)", font: { color: ink() }, uirevision: "contact " + n,
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom" }, hovermode: "closest",
      xaxis: { title: { text: contact.axes[0] + unit("length") }, range: along, anchor: "y3",
        gridcolor: "rgba(128,128,128,0.2)", zeroline: false },
      yaxis: axis("stress" + unit("stress"), [0.5, 1], steady(contact.ranges, "stress", ...stresses)),
      yaxis2: axis("slip" + unit("length"), [0.26, 0.46], steady(contact.ranges, "slip", ...extent(inView(slip)))),
      yaxis3: axis("gap" + unit("length"), [0, 0.2], steady(contact.ranges, "gap", ...extent(inView(gap)))),
    };
    layout.margin.t = 34;
    return Plotly.react("contact", traces, layout, options);
  }
  function drawMap() {
    const n = chosen.contact, contact = shape.contacts[n];
    const [name, words, measured] = MAPS.find(([each]) => each === chosen.map);
    const shown = answer.arrays[n + "." + name], isStatus = name === "status";
    const x = column(contact.at, 0, 2), y = column(contact.at, 1, 2);
    const box = [x, y].map((list) => {
      let low = Infinity, high = -Infinity;
      list.forEach((value) => { low = Math.min(low, value); high = Math.max(high, value); });
      return [low, high];
    });
    const room = 0.05 * Math.max(...box.map(([low, high]) => high - low));
    const padded = [...box.map(([low, high]) => [low - room, high + room]), [-room, room]];
    const [i, j, k] = [0, 1, 2].map((corner) => column(contact.pieces, corner, 3));
    const trace = {
      type: "mesh3d", x, y, z: new Float32Array(x.length), i, j, k, hoverinfo: "skip",
      lighting: { ambient: 1, diffuse: 0, specular: 0 },
      colorbar: { title: { text: words + (measured ? unit(measured) : ""), side: "right" }, thickness: 12, len: 0.8 },
    };
    if (isStatus) {
      const scale = data.colours.flatMap((colour, m) => [[m / 3, colour], [(m + 1) / 3, colour]]);
      const median = (m) => [shown[i[m]], shown[j[m]], shown[k[m]]].sort((a, b) => a - b)[1];
      Object.assign(trace, {
        intensity: Array.from(i.keys(), median), intensitymode: "cell", colorscale: scale,
        cmin: -0.5, cmax: 2.5,
      });
      Object.assign(trace.colorbar, { tickvals: [0, 1, 2], ticktext: STATUS });
    } else {
      const [low, high] = steady(contact.ranges, name, ...extent(shown));
      Object.assign(trace, { intensity: shown, intensitymode: "vertex", colorscale: "Viridis",
        cmin: name === "gap" ? low : 0, cmax: high });
    }
    const layout = sceneLayout(padded, true, "map " + n);
    layout.scene.xaxis.title.text = contact.axes[0] + unit("length");
    layout.scene.yaxis.title.text = contact.axes[1] + unit("length");
    return Plotly.react("contact", [trace], layout, options);
  }

  // ---------------------------------------------------------------- what is shown
  function buttons(place, entries, group) {
    $(place).querySelectorAll("button").forEach((button) => button.remove());
    entries.forEach(([value, words]) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = words;
      button.dataset.group = group;
      button.dataset.value = String(value);
      button.addEventListener("click", () => {
        chosen[group] = value;
        if (bodyNow) factor = readable();
        if (answer) draw();
      });
      $(place).append(button);
    });
  }
  function labels() {
    const factors = [[false, "as they are"], ...(factor > 1 ? [[true, factor + " times"]] : [])];
    if ($("factors").dataset.factor !== String(factor)) {
      $("factors").dataset.factor = String(factor);
      buttons("factors", factors, "magnified");
    }
    document.querySelectorAll("button[data-group]").forEach((button) => {
      const now = button.dataset.group === "magnified" ? chosen.magnified && factor > 1 : chosen[button.dataset.group];
      button.setAttribute("aria-pressed", String(String(now) === button.dataset.value));
    });
  }
  buttons("zones", [[false, "whole body"], [true, "contact zone"]], "zone");
})();
