// The map of the chosen quantity over two keys: a cell is a point of the sweep, and nothing is between.
function makeMap(sweep, { place, keys, shown, option, saidOf, textAt, axisOf, clicked }) {
  const { data } = sweep;

  function draw() {
    place.hidden = keys.family < 0;
    if (place.hidden) return;
    const of = shown()[0];
    const at = (x, y) => {
      const numbers = sweep.numbers.slice();
      numbers[keys.across] = x;
      numbers[keys.family] = y;
      return sweep.rowAt(numbers);
    };
    const xs = data.keys[keys.across].said.map((_, n) => n);
    const ys = data.keys[keys.family].said.map((_, n) => n);
    const rows = ys.map((y) => xs.map((x) => at(x, y)));
    const per = (value) => rows.map((line) => line.map(value));
    const fits = xs.length * 62 < place.clientWidth - 200 && ys.length * 18 < 380;
    const cells = {
      type: "heatmap", x: xs, y: ys, xgap: 1, ygap: 1, colorscale: "Viridis", customdata: rows,
      z: per((row) => (sweep.isOk(row) ? of.values[row] : null)),
      hovertext: per((row) => textAt(of, row)), hoverinfo: "text",
      colorbar: { title: { text: sweep.plain(option().label), side: "right" }, ...sweep.plainNumbers },
    };
    if (fits) {
      cells.text = per((row) => (sweep.isOk(row) ? saidOf(of, row)[0] : ""));
      cells.texttemplate = "%{text}";
    }
    const crosses = { x: [], y: [], customdata: [], hovertext: [] };
    rows.forEach((line, y) => line.forEach((row, x) => {
      if (sweep.isOk(row)) return;
      crosses.x.push(x);
      crosses.y.push(y);
      crosses.customdata.push(row);
      crosses.hovertext.push(textAt(of, row));
    }));
    Plotly.react(place, [cells, Object.assign(crosses, {
      type: "scatter", mode: "markers", hoverinfo: "text", name: "failed",
      marker: { symbol: "x", size: 11, color: sweep.failed },
    })], sweep.layout({
      xaxis: axisOf(keys.across, true), yaxis: axisOf(keys.family, true), shapes: [frame()],
      plot_bgcolor: "#eceff1",
    }), sweep.config);
  }
  function frame() {
    const x = sweep.numbers[keys.across], y = sweep.numbers[keys.family];
    return {
      type: "rect", x0: x - 0.5, x1: x + 0.5, y0: y - 0.5, y1: y + 0.5,
      line: { color: sweep.chosen, width: 3 },
    };
  }
  function follow() {
    if (!place.hidden) Plotly.relayout(place, { shapes: [frame()] });
  }
  // Once it has been drawn.
  function start() { if (place.on) place.on("plotly_click", clicked); }
  return { draw, follow, start };
}
