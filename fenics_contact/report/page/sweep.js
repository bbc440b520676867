// The page of a sweep: its data, which point of the grid is chosen, and what follows it.
(async function () {
  const byId = (id) => document.getElementById(id);
  if (typeof DecompressionStream === "undefined") {
    byId("said").textContent = "This browser cannot show the page: it is of before 2023.";
    return;
  }
  function bytesOf(text) {
    const raw = atob(text);
    const bytes = new Uint8Array(raw.length);
    for (let n = 0; n < raw.length; n++) bytes[n] = raw.charCodeAt(n);
    return bytes;
  }
  async function unpacked(id) {
    const stream = new Blob([bytesOf(byId(id).textContent)]).stream();
    return new Response(stream.pipeThrough(new DecompressionStream("gzip"))).text();
  }
  const library = document.createElement("script");
  library.textContent = await unpacked("sweep-plotly");
  document.head.append(library);
  const data = JSON.parse(await unpacked("sweep-data"));
  const counts = data.keys.map((key) => key.said.length);

  let waiting = false;

  const sweep = {
    data,
    bytesOf,
    numbers: counts.map(() => 0), // of each key's value at the chosen point
    ink: "#1c2733",
    failed: "#b03a2e",
    chosen: "#d6006e",
    // The last key runs fastest.
    rowAt: (numbers) => numbers.reduce((row, number, key) => row * counts[key] + number, 0),
    numbersAt(row) {
      const numbers = counts.map(() => 0);
      for (let key = counts.length - 1; key >= 0; key--) {
        numbers[key] = row % counts[key];
        row = Math.floor(row / counts[key]);
      }
      return numbers;
    },
    row: () => sweep.rowAt(sweep.numbers),
    isOk: (row) => data.codes[row] === 0,
    // Plotly reads some tags of HTML in its texts: names are to be shown as they are.
    plain: (text) => String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;"),
    pointWords(row) {
      return sweep.numbersAt(row).map((n, key) => `${data.keys[key].name} = ${data.keys[key].said[n]}`);
    },
    outcomeWords(row) {
      return sweep.isOk(row) ? "" : data.failures[row] || data.outcomes[row];
    },
    // In lines that a box at the mouse has room for.
    folded(text) {
      return text.replace(/(.{40,60}?)\s/g, "$1\n");
    },
    hover(lines) {
      const shown = lines.filter((line) => line).map(sweep.folded);
      return sweep.plain(shown.join("\n")).replace(/\n/g, "<br>");
    },
    option(select, value, text) {
      const option = document.createElement("option");
      option.value = value;
      option.textContent = text;
      select.append(option);
    },
    layout(more) {
      return Object.assign({
        paper_bgcolor: "#fff", plot_bgcolor: "#fff", font: { color: sweep.ink, size: 13 },
        hovermode: "closest", margin: { l: 70, r: 15, t: 36, b: 55 }, uirevision: "same",
        hoverlabel: { align: "left" },
      }, more);
    },
    // Of axes: powers of ten only where numbers would be long.
    plainNumbers: { exponentformat: "power", minexponent: 5 },
    config: { responsive: true, displaylogo: false, displayModeBar: window.innerWidth >= 600 },
    choose(row) {
      sweep.numbers = sweep.numbersAt(row);
      showPoint();
      // Once before the next picture, however often a slider is moved until then.
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        parts.forEach((part) => part.follow());
      });
    },
  };
  const parts = [makeCurves(sweep), makeStates(sweep), makeTable(sweep)];

  function showPoint() {
    const row = sweep.row();
    sweep.numbers.forEach((number, key) => {
      byId(`key-${key}`).value = number;
      document.querySelector(`output[for="key-${key}"]`).textContent = data.keys[key].said[number];
    });
    const why = sweep.outcomeWords(row);
    byId("said").textContent = `Point ${row + 1} of ${data.codes.length}: `
      + (why ? `${data.outcomes[row]}. ${data.failures[row] || ""}` : parts[0].words(row));
  }
  data.keys.forEach((_, key) => {
    byId(`key-${key}`).addEventListener("input", (event) => {
      const numbers = sweep.numbers.slice();
      numbers[key] = Number(event.target.value);
      sweep.choose(sweep.rowAt(numbers));
    });
  });
  byId("quantities").addEventListener("change", showPoint);
  document.querySelectorAll("#failures [data-row]").forEach((button) => {
    button.addEventListener("click", () => sweep.choose(Number(button.dataset.row)));
  });
  await Promise.all(parts.map((part) => part.start()));
  // First the last point that has an answer: mostly that of the largest values.
  const last = data.codes.lastIndexOf(0);
  sweep.choose(last < 0 ? 0 : last);
  requestAnimationFrame(() => { byId("curves").dataset.ready = "true"; });
})();
