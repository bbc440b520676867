// Curves of the chosen quantity over one key, with error bands, one for each value of another key.
function makeCurves(sweep) {
  const { data } = sweep;
  const byId = (id) => document.getElementById(id);
  const place = byId("curves");
  const select = { quantity: byId("quantity"), owner: byId("owner") };
  const dashes = ["solid", "dash", "dashdot", "dot", "longdash", "longdashdot"];
  const shades = ["#440154", "#414487", "#2a788e", "#22a884", "#7ad151"]; // Viridis without its yellow
  const each = "each";
  const mostNames = 12; // in the legend
  // What is across, and of which key each value has a curve; -1: none.
  const keys = { across: data.keys.length - 1, family: data.keys.length - 2 };
  const options = choices();
  const map = byId("map")
    ? makeMap(sweep, { place: byId("map"), keys, shown, option, saidOf, textAt, axisOf, clicked })
    : null;
  let slice = "";

  // Quantities and components by name, with those that have them.
  function choices() {
    const found = new Map();
    data.quantities.forEach((quantity) => quantity.parts.forEach((part, component) => {
      const made = found.get(part.label) || { label: part.label, of: [] };
      made.of.push({ owner: quantity.owner, quantity, component, values: part.values });
      found.set(part.label, made);
    }));
    return Array.from(found.values());
  }
  function varies(option) {
    return option.of.some(({ values }) => {
      const known = values.filter((value) => value !== null);
      const size = known.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
      return known.some((value) => Math.abs(value - known[0]) > 1e-9 * size);
    });
  }
  function option() { return options[Number(select.quantity.value)]; }
  // Those whose curves are drawn.
  function shown() {
    if (!options.length) return [];
    const { of } = option();
    return select.owner.value === each ? of : [of[Number(select.owner.value)]];
  }
  function nameOf({ owner }) { return owner || "whole model"; }
  function saidOf({ quantity, component }, row) {
    const [values, bar] = quantity.said[row].split(" ± ");
    const value = quantity.parts.length > 1 ? values.split(", ")[component] : values;
    return [value, bar];
  }
  function line(of, row) {
    const [value, bar] = saidOf(of, row);
    const owner = option().of.length > 1 ? `${nameOf(of)}: ` : "";
    return `${owner}${option().label} = ${value || "none"}${bar ? ` ± ${bar}` : ""}`;
  }
  function words(row) { return shown().map((of) => line(of, row)).join(" · "); }
  function textAt(of, row) {
    return sweep.hover([...sweep.pointWords(row), line(of, row), sweep.outcomeWords(row)]);
  }

  function rowsAlong(key, numbers) {
    return data.keys[key].said.map((_, n) => {
      const at = numbers.slice();
      at[key] = n;
      return sweep.rowAt(at);
    });
  }
  function curves() {
    if (keys.family < 0) {
      return shown().map((of, n) => ({
        of, rows: rowsAlong(keys.across, sweep.numbers), name: nameOf(of),
        line: different(n),
      }));
    }
    const key = data.keys[keys.family];
    return key.said.map((said, n) => {
      const numbers = sweep.numbers.slice();
      numbers[keys.family] = n;
      return { of: shown()[0], rows: rowsAlong(keys.across, numbers), name: said, line: styleOf(n) };
    });
  }
  function different(n) {
    return { color: data.colours[n % data.colours.length], dash: dashes[n % dashes.length] };
  }
  // Numbers have shades in their order, words colours that differ.
  function styleOf(n) {
    const { values, said } = data.keys[keys.family];
    if (!values) return different(n);
    const rank = values.filter((value) => value < values[n]).length / Math.max(1, said.length - 1);
    const at = rank * (shades.length - 1), low = Math.min(Math.floor(at), shades.length - 2);
    const parts = [1, 3, 5].map((from) => {
      const [a, b] = [low, low + 1].map((m) => parseInt(shades[m].slice(from, from + 2), 16));
      return Math.round(a + (at - low) * (b - a));
    });
    return { color: `rgb(${parts.join()})`, dash: "solid" };
  }

  // Values that are spread as a power are so on their axis.
  function isLog(values) {
    if (!values || values.length < 3) return false;
    const sorted = values.slice().sort((a, b) => a - b);
    if (!(sorted[0] > 0) || sorted[sorted.length - 1] < 20 * sorted[0]) return false;
    const spread = (of) => {
      const steps = sorted.slice(1).map((value, n) => of(value) - of(sorted[n]));
      return Math.max(...steps) / Math.min(...steps);
    };
    return spread(Math.log) < spread((value) => value);
  }
  function axisOf(key, asCells) {
    const { label, values, said } = data.keys[key];
    const axis = { title: { text: sweep.plain(label) }, automargin: true, zeroline: false };
    if (values && !asCells) return Object.assign(axis, { type: isLog(values) ? "log" : "linear" });
    const text = (n) => (values ? String(Number(values[n].toPrecision(4))) : short(said[n]));
    const widest = said.reduce((most, _, n) => Math.max(most, text(n).length), 0);
    const room = key === keys.across ? Math.max(3, place.clientWidth / (8 * widest + 20)) : 20;
    const step = Math.ceil(said.length / room);
    const kept = said.map((_, n) => n).filter((n) => n % step === 0);
    return Object.assign(axis, {
      type: "linear", tickvals: kept, ticktext: kept.map((n) => sweep.plain(text(n))),
      range: [-0.5, said.length - 0.5], showgrid: false,
    });
  }
  function short(text) { return text.length > 24 ? `${text.slice(0, 22)}…` : text; }
  function isWord() { return !data.keys[keys.across].values; }
  function xOf(row) {
    const n = sweep.numbersAt(row)[keys.across];
    const { values } = data.keys[keys.across];
    return values ? values[n] : n;
  }

  // Runs of points that follow each other and have answers.
  function runs({ of, rows }) {
    const found = [[]];
    rows.forEach((row) => {
      if (sweep.isOk(row) && of.values[row] !== null) found[found.length - 1].push(row);
      else found.push([]);
    });
    return found.filter((run) => run.length);
  }
  function hasBar({ quantity }, row) { return quantity.bars !== null && quantity.bars[row] !== null; }
  function band(curve, number, isFirst) {
    const { of } = curve;
    const ends = (row, side) => of.values[row] + side * of.quantity.bars[row];
    const x = [], y = [];
    runs(curve).forEach((run) => {
      const parted = [[]];
      run.forEach((row) => {
        if (hasBar(of, row)) parted[parted.length - 1].push(row);
        else parted.push([]);
      });
      parted.filter((part) => part.length > 1).forEach((part) => {
        const back = part.slice().reverse();
        x.push(...part.map(xOf), ...back.map(xOf), null);
        y.push(...part.map((row) => ends(row, 1)), ...back.map((row) => ends(row, -1)), null);
      });
    });
    return {
      type: "scatter", mode: "lines", x, y, fill: "toself", line: { width: 0, color: curve.line.color },
      fillcolor: curve.line.color, opacity: 0.22, hoverinfo: "skip", name: "estimated error",
      legendgroup: `curve ${number}`, showlegend: isFirst,
    };
  }
  function lineOf(curve, number, count) {
    const { of, rows } = curve;
    const known = rows.map((row) => sweep.isOk(row) && of.values[row] !== null);
    const alone = new Set(runs(curve).filter((run) => run.length === 1).map(([row]) => row));
    const bars = rows.map((row, n) =>
      (known[n] && hasBar(of, row) && (isWord() || alone.has(row)) ? of.quantity.bars[row] : 0));
    const every = Math.ceil(count / mostNames);
    return {
      type: "scatter", mode: isWord() ? "markers" : "lines+markers", connectgaps: false,
      x: rows.map(xOf), y: rows.map((row, n) => (known[n] ? of.values[row] : null)), customdata: rows,
      error_y: { array: bars, visible: bars.some((bar) => bar > 0), thickness: 1.5 },
      line: Object.assign({ width: 2 }, curve.line),
      marker: { size: isWord() ? 9 : rows.length > 60 ? 4 : 6 },
      hovertext: rows.map((row) => textAt(of, row)), hoverinfo: "text", name: sweep.plain(curve.name),
      legendgroup: `curve ${number}`, showlegend: count > 1 && number % every === 0,
    };
  }
  // Points without an answer stand at the foot; numbers of answers that failed a check where they are.
  function failed(all, isFoot) {
    const marks = { x: [], y: [], customdata: [], hovertext: [] };
    all.forEach(({ of, rows }) => rows.forEach((row) => {
      if (sweep.isOk(row) || (of.values[row] === null) !== isFoot) return;
      marks.x.push(xOf(row));
      marks.y.push(isFoot ? 0.025 : of.values[row]);
      marks.customdata.push(row);
      marks.hovertext.push(textAt(of, row));
    }));
    return Object.assign(marks, {
      type: "scatter", mode: "markers", yaxis: isFoot ? "y2" : "y", hoverinfo: "text", cliponaxis: false,
      name: isFoot ? "failed, no answer" : "not to be trusted", showlegend: marks.x.length > 0,
      marker: { symbol: isFoot ? "x" : "x-open", size: 11, color: sweep.failed },
    });
  }
  // A ring around the chosen point, and lines at points that failed where there is one curve.
  function shapes(all) {
    const row = sweep.row();
    const of = all.filter(({ rows }) => rows.includes(row)).map((curve) => curve.of);
    const rings = of.filter(({ values }) => values[row] !== null).map(({ values }) => ({
      type: "circle", xsizemode: "pixel", ysizemode: "pixel", xanchor: xOf(row), yanchor: values[row],
      x0: -8, x1: 8, y0: -8, y1: 8, line: { color: sweep.chosen, width: 2.5 },
    }));
    return [...(keys.family < 0 ? failedLines(all[0].rows) : []), ...rings];
  }
  function failedLines(rows) {
    return rows.filter((row) => !sweep.isOk(row)).map((row) => ({
      type: "line", x0: xOf(row), x1: xOf(row), y0: 0, y1: 1, yref: "paper",
      line: { color: sweep.failed, width: 1, dash: "dot" },
    }));
  }
  function sorted(curve) {
    return Object.assign(curve, { rows: curve.rows.slice().sort((a, b) => xOf(a) - xOf(b)) });
  }

  function draw() {
    if (!options.length) return undefined;
    const all = curves().map(sorted);
    slice = sliceOf();
    const barred = all.filter(({ of, rows }) => rows.some((row) => hasBar(of, row)));
    const bands = isWord() ? [] : barred; // between words there is nothing
    const traces = [
      ...bands.map((curve, n) => band(curve, all.indexOf(curve), n === 0)),
      ...all.map((curve, n) => lineOf(curve, n, all.length)),
      failed(all, true), failed(all, false),
    ];
    const key = keys.family < 0 ? "" : sweep.plain(data.keys[keys.family].label);
    byId("about").textContent = about(all, barred);
    const narrow = place.clientWidth < 600;
    if (map) map.draw();
    return Plotly.react(place, traces, sweep.layout({
      xaxis: axisOf(keys.across, false), shapes: shapes(all),
      yaxis: { title: { text: sweep.plain(option().label) }, automargin: true, ...sweep.plainNumbers },
      yaxis2: { overlaying: "y", range: [0, 1], visible: false, fixedrange: true },
      legend: Object.assign(
        { title: { text: key, side: "top" } }, narrow ? { orientation: "h", y: -0.3 } : {},
      ),
      uirevision: [select.quantity.value, select.owner.value, keys.across, keys.family].join(),
    }), sweep.config);
  }
  function about(all, barred) {
    const rows = all.flatMap((curve) => curve.rows);
    const fails = new Set(rows.filter((row) => !sweep.isOk(row)));
    const said = [];
    const isFixed = (_, key) => key !== keys.across && key !== keys.family;
    const fixed = sweep.pointWords(sweep.row()).filter(isFixed);
    if (fixed.length) said.push(`At ${fixed.join(", ")}.`);
    const bars = isWord() ? "bar" : "band";
    if (barred.length) {
      said.push(`The ${bars}s are estimated errors; where a point has no ${bars}, its error is not known.`);
    } else said.push("No errors of this quantity were estimated.");
    if (fails.size) said.push("Curves are interrupted at crosses: these points failed.");
    return said.join(" ");
  }

  // What all that is drawn depends on, but for the mark of the chosen point.
  function sliceOf() {
    return sweep.numbers.map((n, key) => (key === keys.across || key === keys.family ? "" : n)).join();
  }
  function follow() {
    if (!options.length) return;
    if (sliceOf() !== slice) {
      draw();
      return;
    }
    Plotly.relayout(place, { shapes: shapes(curves()) });
    if (map) map.follow();
  }

  function fillOwners() {
    const [chosen] = select.owner.selectedOptions;
    const before = chosen && chosen.textContent;
    select.owner.replaceChildren();
    const { of } = option();
    if (of.length > 1 && keys.family < 0) sweep.option(select.owner, each, "each");
    of.forEach((one, n) => sweep.option(select.owner, n, nameOf(one)));
    const same = Array.from(select.owner.options).find((one) => one.textContent === before);
    if (same) select.owner.value = same.value;
    select.owner.parentElement.hidden = of.length < 2;
  }
  function fillKeys() {
    const [across, family] = [byId("across"), byId("family")];
    data.keys.forEach((key, n) => {
      sweep.option(across, n, key.name);
      sweep.option(family, n, key.name);
    });
    sweep.option(family, -1, "none: one curve");
    const show = () => {
      across.value = keys.across;
      family.value = keys.family;
      fillOwners();
      draw();
    };
    across.addEventListener("change", () => {
      if (Number(across.value) === keys.family) keys.family = keys.across;
      keys.across = Number(across.value);
      show();
    });
    family.addEventListener("change", () => {
      if (Number(family.value) === keys.across) keys.across = keys.family < 0 ? other() : keys.family;
      keys.family = Number(family.value);
      show();
    });
    across.value = keys.across;
    family.value = keys.family;
  }
  function other() { return data.keys.findIndex((_, key) => key !== keys.across); }
  function clicked(event) {
    const { customdata } = event.points[0];
    // Not from within the event: all is drawn again.
    if (Number.isInteger(customdata)) setTimeout(() => sweep.choose(customdata), 0);
  }

  async function start() {
    if (!options.length) {
      byId("quantities").hidden = true;
      return;
    }
    options.forEach((one, n) => sweep.option(select.quantity, n, one.label));
    select.quantity.value = Math.max(0, options.findIndex(varies));
    fillOwners();
    if (map) fillKeys();
    select.quantity.addEventListener("change", () => {
      fillOwners();
      draw();
    });
    select.owner.addEventListener("change", draw);
    await draw();
    place.on("plotly_click", clicked);
    if (map) map.start();
  }
  return { start, follow, words };
}
