// The table of all points, some hundred at a time.
function makeTable(sweep) {
  const { data } = sweep;
  const most = 200; // rows that are shown at a time
  const few = 7; // quantities, where not all are shown
  const place = document.querySelector("#rows table");
  const all = document.getElementById("all");
  let first = -1;

  function cell(row, text, kind = "td") {
    const made = document.createElement(kind);
    made.textContent = text;
    row.append(made);
    return made;
  }
  function shown() { return all.checked ? data.quantities : data.quantities.slice(0, few); }
  function head() {
    const row = document.createElement("tr");
    const names = shown().map((one) => (one.owner ? `${one.owner}: ` : "") + one.label);
    const titles = ["point", ...data.keys.map((key) => key.label), "outcome", ...names];
    titles.forEach((text) => { cell(row, text, "th").scope = "col"; });
    return row;
  }
  function line(number) {
    const row = document.createElement("tr");
    row.dataset.row = number;
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = number + 1;
    button.addEventListener("click", () => sweep.choose(number));
    const named = cell(row, "", "th");
    named.scope = "row";
    named.append(button);
    sweep.numbersAt(number).forEach((n, key) => cell(row, data.keys[key].said[n]));
    const outcome = document.createElement("span");
    outcome.className = sweep.isOk(number) ? "ok" : "bad";
    outcome.textContent = data.outcomes[number];
    outcome.title = sweep.outcomeWords(number);
    cell(row, "").append(outcome);
    shown().forEach((quantity) => cell(row, quantity.said[number]));
    return row;
  }
  function draw(from) {
    first = from;
    const end = Math.min(from + most, data.codes.length);
    place.tHead.replaceChildren(head());
    const numbers = Array.from({ length: end - from }, (_, n) => from + n);
    place.tBodies[0].replaceChildren(...numbers.map(line));
    document.getElementById("pages").hidden = data.codes.length <= most;
    document.getElementById("which").textContent = `${from + 1} to ${end} of ${data.codes.length}`;
    document.getElementById("before").disabled = from === 0;
    document.getElementById("after").disabled = end === data.codes.length;
    mark();
  }
  function mark() {
    const chosen = String(sweep.row());
    Array.from(place.tBodies[0].rows).forEach((row) => {
      row.classList.toggle("chosen", row.dataset.row === chosen);
      if (row.dataset.row === chosen) bring(row);
    });
  }
  // Into the part of the list that is seen; the page stays where it is.
  function bring(row) {
    const list = place.parentElement;
    const top = row.offsetTop - place.tHead.offsetHeight;
    const bottom = row.offsetTop + row.offsetHeight - list.clientHeight;
    list.scrollTop = Math.min(Math.max(list.scrollTop, bottom), top);
  }
  function follow() {
    const from = Math.floor(sweep.row() / most) * most;
    if (from === first) mark(); else draw(from);
  }
  async function start() {
    all.addEventListener("change", () => draw(first));
    all.parentElement.hidden = data.quantities.length <= few;
    document.getElementById("before").addEventListener("click", () => draw(first - most));
    document.getElementById("after").addEventListener("click", () => draw(first + most));
  }
  return { start, follow };
}
