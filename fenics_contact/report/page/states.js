// The contact at the chosen point: curves along a line, or maps of its points over a surface.
function makeStates(sweep) {
  const { data } = sweep;
  const byId = (id) => document.getElementById(id);
  const place = byId("state"), second = byId("status"), same = byId("same");
  const select = byId("contact");
  const edge = "#8f9ba3";
  const nothing = -32768; // not a number, of 16 bits
  const names = Object.keys(data.fields);
  const marker = ["circle-open", "circle", "square-open"]; // open, stick, slip
  const numbers = {}, states = new Map();
  let status, field = 0;

  function unpack() {
    names.forEach((name) => { numbers[name] = new Int16Array(sweep.bytesOf(data.fields[name]).buffer); });
    status = new Int8Array(sweep.bytesOf(data.status).buffer);
    data.shapes.forEach((shape) => {
      shape.positions = shape.positions.map((text) => new Float32Array(sweep.bytesOf(text).buffer));
      shape.count = shape.positions[0].length;
    });
    let from = 0;
    data.states.forEach(([point, contact, number, ...sizes]) => {
      const shape = data.shapes[number];
      states.set(`${point}/${contact}`, { shape, from, to: from + shape.count, sizes });
      from += shape.count;
    });
  }
  function valuesOf(state, name) {
    const size = state.sizes[names.indexOf(name)];
    const whole = numbers[name].subarray(state.from, state.to);
    return Array.from(whole, (value) => (value === nothing ? null : value * size));
  }
  function statusOf(state) { return status.subarray(state.from, state.to); }
  function contact() { return Number(select.value || 0); }
  function ofContact() {
    return Array.from(states).filter(([key]) => key.endsWith(`/${contact()}`)).map(([, state]) => state);
  }
  // Where nothing carries a force along the surface, nothing sticks or slips.
  function kinds() {
    const [open, stick, slip] = data.statuses;
    return data.rough[contact()]
      ? [{ of: [1], ...stick }, { of: [2], ...slip }, { of: [0], ...open }]
      : [{ of: [1, 2], name: "in contact", colour: stick.colour }, { of: [0], ...open }];
  }

  function written(value) { return value === null ? "none" : Number(value.toPrecision(4)).toString(); }
  function hoverTexts(state) {
    const { shape } = state;
    const values = names.map((name) => valuesOf(state, name));
    const now = statusOf(state);
    const unit = data.length ? ` ${data.length}` : "";
    return Array.from(now, (kind, n) => sweep.hover([
      shape.labels.map((label, axis) => `${label} = ${written(shape.positions[axis][n])}${unit}`).join(", "),
      ...names.map((name, m) => `${data.labels[name]} = ${written(values[m][n])}`),
      kinds().find((one) => one.of.includes(kind)).name,
    ]));
  }
  function rangeOf(all, name, within) {
    let low = 0, high = 0;
    all.forEach((state) => valuesOf(state, name).forEach((value, n) => {
      if (value === null || (within && !within(state, n))) return;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }));
    return [low, high];
  }
  const ranges = {};
  // The ends of a field: at all points of the sweep, or at the chosen one.
  function ends(state, name, within) {
    if (!same.checked) return rangeOf([state], name, within);
    const key = `${contact()}/${name}`;
    ranges[key] = ranges[key] || rangeOf(ofContact(), name, within);
    return ranges[key];
  }
  function wider([low, high], share) {
    const margin = share * (high - low) || 1;
    return [low - margin, high + margin];
  }
  const zones = {};
  // What is shown: around all that ever touches, of each coordinate.
  function zone() {
    if (zones[contact()]) return zones[contact()];
    const all = ofContact();
    const axes = all[0].shape.positions.length;
    const limits = (touching) => Array.from({ length: axes }, (_, axis) => {
      let low = Infinity, high = -Infinity;
      all.forEach((state) => statusOf(state).forEach((kind, n) => {
        if (touching && kind === 0) return;
        low = Math.min(low, state.shape.positions[axis][n]);
        high = Math.max(high, state.shape.positions[axis][n]);
      }));
      return [low, high];
    });
    const whole = limits(false), inner = limits(true);
    const reach = 0.35 * Math.max(...inner.map(([low, high]) => high - low));
    zones[contact()] = whole.map(([low, high], axis) => (Number.isFinite(reach) && reach > 0
      ? wider([Math.max(low, inner[axis][0] - reach), Math.min(high, inner[axis][1] + reach)], 0.06)
      : wider([low, high], 0.06)));
    return zones[contact()];
  }

  // Values with an empty place where the line is interrupted.
  function parted(values, breaks) {
    const found = Array.from(values);
    breaks.slice().reverse().forEach((at) => found.splice(at, 0, null));
    return found;
  }
  function shownFields() {
    const all = ofContact();
    return names.filter((name) => rangeOf(all, name).some((end) => end !== 0));
  }
  const fieldsOf = {};
  function drawLine(state) {
    const { shape } = state;
    fieldsOf[contact()] = fieldsOf[contact()] || shownFields();
    const panels = fieldsOf[contact()];
    const x = Array.from(shape.positions[0]);
    const limits = zone()[0];
    const within = (of, n) => of.shape.positions[0][n] >= limits[0] && of.shape.positions[0][n] <= limits[1];
    const now = Array.from(statusOf(state));
    const texts = hoverTexts(state);
    const unit = data.length && ` (${data.length})`;
    const along = shape.labels[0];
    const title = along.length > 1 ? along : `position along the surface, ${along}`;
    const layout = {
      height: 90 + 165 * panels.length, legend: { orientation: "h", y: 1.02, yanchor: "bottom" },
      margin: { l: 80, r: 15, t: 40, b: 55 },
      xaxis: {
        title: { text: sweep.plain(title + unit) }, range: limits, zeroline: false,
        anchor: `y${panels.length > 1 ? panels.length : ""}`,
      },
    };
    const traces = [];
    panels.forEach((name, n) => {
      const axis = n ? `y${n + 1}` : "y";
      const values = valuesOf(state, name);
      traces.push({
        type: "scatter", mode: "lines", x: parted(x, shape.breaks), y: parted(values, shape.breaks),
        yaxis: axis, hoverinfo: "skip", showlegend: false, line: { color: "#9aa5ad", width: 1 },
      });
      kinds().forEach((kind) => {
        const own = now.map((_, m) => m).filter((m) => kind.of.includes(now[m]));
        traces.push({
          type: "scatter", mode: "markers", name: kind.name, legendgroup: kind.name, yaxis: axis,
          x: own.map((m) => x[m]), y: own.map((m) => values[m]), hovertext: own.map((m) => texts[m]),
          hoverinfo: "text", showlegend: n === 0,
          marker: {
            size: x.length > 120 ? 4 : 6, symbol: marker[kind.of[0]],
            color: kind.of[0] === 0 ? edge : kind.colour, // an open ring would fade on white
            line: { width: x.length > 120 ? 1 : 1.5 },
          },
        });
      });
      const height = 1 / panels.length, gap = 0.16 * height;
      layout[n ? `yaxis${n + 1}` : "yaxis"] = {
        title: { text: sweep.plain(data.labels[name]).replace(" (", "<br>("), standoff: 8 },
        range: wider(ends(state, name, within), 0.06), automargin: true,
        domain: [1 - (n + 1) * height + gap / 2, 1 - n * height - gap / 2], ...sweep.plainNumbers,
        zerolinecolor: "#5d6b78",
      };
    });
    second.hidden = true;
    place.classList.add("line");
    react(place, traces, layout);
  }

  function drawSurface(state) {
    const name = names[field];
    const { shape } = state;
    const isPlane = shape.positions.length === 2;
    const texts = hoverTexts(state);
    const [x, y, z] = shape.positions.map((axis) => Array.from(axis));
    const limits = zone();
    const size = markerSize(shape, limits, isPlane);
    const [low, high] = ends(state, name);
    const base = {
      type: isPlane ? "scatter" : "scatter3d", mode: "markers", hoverinfo: "text", showlegend: false,
    };
    const at = (own) => Object.assign(
      { x: own.map((m) => x[m]), y: own.map((m) => y[m]), hovertext: own.map((m) => texts[m]) },
      isPlane ? {} : { z: own.map((m) => z[m]) },
    );
    const everyPoint = x.map((_, m) => m);
    const values = valuesOf(state, name);
    const coloured = Object.assign(at(everyPoint), base, {
      marker: {
        size, color: values, colorscale: "Viridis", cmin: low, cmax: high > low ? high : low + 1,
        showscale: true, line: { width: 0 },
        colorbar: {
          orientation: "h", y: isPlane ? -0.24 : 0.16, yanchor: "top", thickness: 12, len: 1,
          ...sweep.plainNumbers,
        },
      },
    });
    const now = Array.from(statusOf(state));
    const parts = kinds().map((kind) => Object.assign(
      at(everyPoint.filter((m) => kind.of.includes(now[m]))), base,
      { name: kind.name, showlegend: true, marker: { size, color: kind.colour, line: { width: 0 } } },
    ));
    second.hidden = false;
    place.classList.remove("line");
    const layout = isPlane ? planeLayout(shape, limits) : spaceLayout(shape, limits);
    react(place, [coloured], Object.assign({ title: titled(data.labels[name]) }, layout));
    react(second, parts, Object.assign({ title: titled("status") }, layout, {
      legend: { orientation: "h", y: isPlane ? -0.26 : 0.14, yanchor: "top" },
    }));
  }
  function titled(text) {
    const place = { x: 0.02, xanchor: "left", y: 0.98, yanchor: "top" };
    return Object.assign({ text: sweep.plain(text), font: { size: 14 } }, place);
  }
  // As large as points have room for.
  function markerSize(shape, limits, isPlane) {
    const [width, height] = limits.map(([low, high]) => high - low);
    const [x, y] = shape.positions;
    let inside = 0;
    x.forEach((_, n) => {
      const within = (value, [low, high]) => value >= low && value <= high;
      if (within(x[n], limits[0]) && within(y[n], limits[1])) inside++;
    });
    const scale = Math.min(360 / width, 300 / height);
    const side = scale * Math.sqrt((width * height) / Math.max(1, inside));
    return Math.max(3, Math.min(isPlane ? 16 : 9, 1.2 * side));
  }
  function withUnit(label) { return sweep.plain(label + (data.length && ` (${data.length})`)); }
  function planeLayout(shape, limits) {
    return {
      height: null, margin: { l: 70, r: 15, t: 60, b: 110 },
      xaxis: { title: { text: withUnit(shape.labels[0]) }, range: limits[0], zeroline: false },
      yaxis: {
        title: { text: withUnit(shape.labels[1]) }, range: limits[1], scaleanchor: "x", zeroline: false,
      },
    };
  }
  function spaceLayout(shape, limits) {
    const axes = {};
    ["xaxis", "yaxis", "zaxis"].forEach((axis, n) => {
      axes[axis] = { title: { text: withUnit(shape.labels[n]) }, range: limits[n] };
    });
    const [a, b, c] = shape.normal;
    const side = (c || b || a) < 0 ? -1 : 1;
    const eye = { x: 1.5 * side * a + 0.4, y: 1.5 * side * b - 0.6, z: 1.5 * side * c + 0.4 };
    return {
      height: null, margin: { l: 0, r: 0, t: 30, b: 10 },
      scene: Object.assign(axes, {
        domain: { y: [0.2, 1] }, aspectmode: "data", camera: { eye, projection: { type: "orthographic" } },
      }),
    };
  }
  function react(div, traces, layout) {
    const kept = [contact(), same.checked, div === place ? field : ""].join();
    Plotly.react(div, traces, sweep.layout(Object.assign({ uirevision: kept }, layout)), sweep.config);
  }

  function follow() {
    if (!states.size) return;
    const state = states.get(`${sweep.row()}/${contact()}`);
    byId("no-state").hidden = Boolean(state);
    place.hidden = !state;
    second.hidden = !state;
    if (!state) {
      byId("no-state").textContent = sweep.outcomeWords(sweep.row())
        || "The contact at this point is not in the page; states.npz has it.";
      return;
    }
    const isLine = state.shape.positions.length === 1;
    byId("fields").hidden = isLine;
    if (isLine) drawLine(state); else drawSurface(state);
  }
  async function start() {
    byId("thinned").textContent = data.thinned;
    if (!data.states.length) {
      byId("states").hidden = true;
      return;
    }
    unpack();
    const has = new Set(data.states.map(([, number]) => number));
    data.contacts.forEach((name, n) => { if (has.has(n)) sweep.option(select, n, name); });
    byId("contacts").hidden = select.options.length < 2;
    select.addEventListener("change", follow);
    same.addEventListener("change", follow);
    names.forEach((name, n) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = name;
      button.setAttribute("aria-pressed", n === field);
      button.addEventListener("click", () => {
        field = n;
        byId("fields").querySelectorAll("button").forEach((one, m) => {
          one.setAttribute("aria-pressed", m === field);
        });
        follow();
      });
      byId("fields").append(button);
    });
  }
  return { start, follow };
}
