"use strict";
(function () {
  const place = document.getElementById("view");
  const said = document.getElementById("said");
  const data = JSON.parse(document.getElementById("look-data").textContent);
  const colours = [
    "#7aa6c2", "#c9a26b", "#8fb58a", "#b58fb0", "#c98b82", "#8e9bb8", "#b3b077", "#77b3ae",
  ];
  const chosenColour = "#e8590c";
  const edge = "#33404d";

  function decoded(text) {
    const raw = atob(text);
    const bytes = new Uint8Array(raw.length);
    for (let n = 0; n < raw.length; n++) bytes[n] = raw.charCodeAt(n);
    return new Float32Array(bytes.buffer);
  }
  function column(values, axis) {
    const found = new Float32Array(values.length / 3);
    for (let n = 0; n < found.length; n++) found[n] = values[3 * n + axis];
    return found;
  }
  function every(count, first) {
    return Array.from({ length: count / 3 }, (_, n) => 3 * n + first);
  }
  function colourOf(surface) {
    return surface.bodies.length ? colours[surface.bodies[0] % colours.length] : "#999999";
  }
  // Edges of one triangle only, at which a surface ends.
  function border(points) {
    const seen = new Map();
    for (let t = 0; t < points.length / 9; t++) {
      const corners = [0, 1, 2].map((n) => Array.from(points.subarray(9 * t + 3 * n, 9 * t + 3 * n + 3)));
      [[0, 1], [1, 2], [2, 0]].forEach(([a, b]) => {
        const key = [corners[a].join(), corners[b].join()].sort().join("|");
        seen.set(key, seen.has(key) ? null : [corners[a], corners[b]]);
      });
    }
    return Array.from(seen.values()).filter((ends) => ends);
  }
  function lines(pairs, axis) {
    return pairs.flatMap(([a, b]) => [a[axis], b[axis], null]);
  }
  // In the plane the first edge of every other triangle is the curve itself.
  function curve(points) {
    const pairs = [];
    for (let t = 0; t < points.length / 9; t += 2) {
      pairs.push([0, 3].map((n) => [points[9 * t + n], points[9 * t + n + 1]]));
    }
    return pairs;
  }
  function traceOf(points, colour, name) {
    if (data.flat) {
      const pairs = curve(points);
      return {
        type: "scatter", mode: "lines+markers", x: lines(pairs, 0), y: lines(pairs, 1),
        line: { color: colour, width: 4 }, marker: { color: colour, size: 3 },
        text: name, hoverinfo: "text", name,
      };
    }
    const count = points.length / 3;
    return {
      type: "mesh3d", x: column(points, 0), y: column(points, 1), z: column(points, 2),
      i: every(count, 0), j: every(count, 1), k: every(count, 2), color: colour,
      flatshading: true, hoverinfo: "text", text: name, name,
      lighting: { ambient: 0.6, diffuse: 0.7, specular: 0.1 },
    };
  }

  const points = data.surfaces.map((surface) => decoded(surface.points));
  const traces = data.surfaces.map((surface, n) =>
    traceOf(points[n], colourOf(surface), surface.called));
  const rest = decoded(data.rest);
  if (rest.length) traces.push(traceOf(rest, "#c8ccd0", "in no group"));
  if (!data.flat) {
    data.surfaces.forEach((surface, n) => {
      const pairs = border(points[n]);
      traces.push({
        type: "scatter3d", mode: "lines", hoverinfo: "skip", line: { color: edge, width: 2 },
        x: lines(pairs, 0), y: lines(pairs, 1), z: lines(pairs, 2),
      });
    });
  }
  // Numbers stand a little before their surfaces; those behind bodies are hidden.
  const numbers = {
    type: data.flat ? "scatter" : "scatter3d", mode: "text", hoverinfo: "skip", visible: false,
    text: data.surfaces.map((surface) => surface.called), textfont: { size: 15 },
    x: data.surfaces.map((surface) => surface.at[0]),
    y: data.surfaces.map((surface) => surface.at[1]),
  };
  if (!data.flat) {
    numbers.z = data.surfaces.map((surface) => surface.at[2]);
    numbers.textfont.color = "#111";
  }
  const firstEdge = traces.length - data.surfaces.length;
  const pickedTrace = traces.length;
  traces.push({
    type: data.flat ? "scatter" : "scatter3d", mode: "lines+markers", hoverinfo: "skip",
    line: { color: chosenColour, width: 6 }, marker: { color: chosenColour, size: 5 },
    x: [], y: [], z: data.flat ? undefined : [],
  });
  traces.push(numbers);
  const dark = window.matchMedia("(prefers-color-scheme: dark)").matches;
  const ink = dark ? "#e4e9ee" : "#1c2733";
  const layout = {
    showlegend: false, margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)", font: { color: ink }, hovermode: "closest",
    scene: {
      aspectmode: "data", camera: { projection: { type: "orthographic" } },
    },
    modebar: { bgcolor: "rgba(0,0,0,0)", color: "#8a97a3", activecolor: ink },
    xaxis: { title: { text: "x" } }, yaxis: { scaleanchor: "x", title: { text: "y" } },
  };
  if (data.flat) layout.margin = { l: 50, r: 10, t: 10, b: 40 };

  let chosen = [], clicked = null;
  function paint(numbers, colour) {
    numbers.forEach((n) => {
      const wanted = colour || colourOf(data.surfaces[n]);
      Plotly.restyle(place, data.flat ? { "line.color": wanted, "marker.color": wanted }
        : { color: wanted }, [n]);
    });
  }
  function describe(n) {
    const surface = data.surfaces[n];
    const bodies = surface.bodies.map((b) => `${data.bodies[b].number} ${data.bodies[b].name}`);
    return [
      `${data.flat ? "curve" : "surface"} ${surface.called}`, surface.names, surface.kind,
      surface.measure, surface.place, `of body ${bodies.join(", ")}`,
    ].filter((text) => text).join(" · ");
  }
  function pick(pieces, text) {
    const drawn = { x: [lines(pieces, 0)], y: [lines(pieces, 1)] };
    if (!data.flat) drawn.z = [lines(pieces, 2)];
    Plotly.restyle(place, drawn, [pickedTrace]);
    said.textContent = text;
  }
  function choose(numbers) {
    pick([], "");
    paint(chosen, null);
    chosen = numbers;
    clicked = numbers.length === 1 ? numbers[0] : null;
    paint(chosen, chosenColour);
    said.textContent = chosen.map(describe).join("\n");
    document.querySelectorAll("[data-surface]").forEach((button) => {
      const isChosen = chosen.includes(Number(button.dataset.surface));
      button.setAttribute("aria-pressed", isChosen ? "true" : "false");
    });
  }
  function show() {
    const shown = new Set(Array.from(document.querySelectorAll("[data-body]"))
      .filter((box) => box.checked).map((box) => Number(box.dataset.body)));
    const visible = data.surfaces.map((surface) => surface.bodies.some((b) => shown.has(b)));
    const text = data.surfaces.map((surface, n) => (visible[n] ? surface.called : ""));
    Plotly.restyle(place, { text: [text] }, [traces.length - 1]);
    Plotly.restyle(place, { visible }, data.surfaces.map((_, n) => n));
    if (!data.flat) Plotly.restyle(place, { visible }, data.surfaces.map((_, n) => firstEdge + n));
  }

  Plotly.newPlot(place, traces, layout, { responsive: true, displaylogo: false }).then(() => {
    // While the button is down every drawing is a click again: not from within the event.
    place.on("plotly_click", (event) => {
      const number = event.points[0].curveNumber;
      if (number >= data.surfaces.length || clicked === number) return;
      clicked = number;
      setTimeout(() => choose([number]), 0);
    });
    document.querySelectorAll("[data-surface]").forEach((button) => {
      button.addEventListener("click", () => choose([Number(button.dataset.surface)]));
    });
    document.querySelectorAll("[data-place]").forEach((button) => {
      const found = data.places[Number(button.dataset.place)];
      button.addEventListener("click", () => {
        choose([]);
        pick(found.pieces, found.called);
      });
    });
    document.querySelectorAll("[data-pair]").forEach((button) => {
      button.addEventListener("click", () => choose(data.pairs[Number(button.dataset.pair)]));
    });
    document.querySelectorAll("[data-body]").forEach((box) => {
      box.addEventListener("change", show);
    });
    const labels = document.getElementById("numbers");
    labels.addEventListener("change", () => {
      Plotly.restyle(place, { visible: labels.checked }, [traces.length - 1]);
    });
    place.dataset.ready = "true";
  });
})();
