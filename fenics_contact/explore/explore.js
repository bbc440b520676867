"use strict";
(function () {
  const data = JSON.parse(document.getElementById("explore-data").textContent);
  const $ = (id) => document.getElementById(id);
  const drawing = window.exploreDrawing(data);
  const values = {};
  Object.entries(data.keys).forEach(([key, one]) => { values[key] = one.start; });
  let shape = null, answer = null, bodyNow = null, obstacleNow = [], factor = 1;
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
    if (kind === "solve") tell("", "Solving, with checks and error bars", []);
    socket.send(JSON.stringify({ number, kind, values }));
  }
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
    $("scene-text").value = text;
    try {
      await navigator.clipboard.writeText(text);
      $("copied-said").textContent = "Copied. It is for a file beside the scene that you explore.";
    } catch (error) {
      $("scene-text").select();
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
    obstacleNow = [];
    chosen.contact = Math.min(chosen.contact, Math.max(shape.contacts.length - 1, 0));
    buttons("contacts", shape.contacts.map((c, n) => [n, c.name]), "contact");
    $("contacts").hidden = shape.contacts.length < 2;
    $("contact").hidden = shape.contacts.length === 0;
    buttons("shown", drawing.maps, "map");
    $("shown").hidden = shape.dimension === 2 || shape.contacts.length === 0;
    document.body.dataset.ready = "";
    drawing.clear();
  }
  function takeAnswer(found) {
    answer = found;
    if (found.arrays.displacement) {
      bodyNow = found.arrays.displacement;
      obstacleNow = shape.contacts.map((_, n) => found.arrays[n + ".obstacle"]);
    }
    if (!document.body.dataset.ready) chosen.zone = zoneSize() < 0.4 * shape.size;
    if (bodyNow && (found.whole || !document.body.dataset.ready)) factor = readable();
    tableOf(found);
    if (found.whole) tell(found.passed ? "ok" : "bad", found.passed ? "✓ OK" : "✗ Not to be trusted", found.said);
    else tell("", found.start === "followed" ? "Followed from the last answer" : "Quick answer", found.said);
    draw();
    if (!document.body.dataset.ready) {
      document.body.dataset.ready = String(Math.round(performance.now()));
      if (!found.whole) ask("solve");
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
  // While one answer is drawn others may come: the latest is drawn next.
  let isDrawing = false, isWanted = false;
  function draw() {
    isWanted = true;
    if (isDrawing) return;
    isDrawing = true;
    requestAnimationFrame(async () => {
      while (isWanted) {
        isWanted = false;
        labels();
        const number = answer.number;
        if (bodyNow) await drawing.body(shape, answer, bodyNow, obstacleNow, chosen, factor);
        if (shape.contacts.length) await drawing.contact(shape, answer, chosen);
        document.body.dataset.drawn = String(Number(document.body.dataset.drawn) + 1);
        document.body.dataset.shown = String(number);
      }
      isDrawing = false;
    });
  }
  window.addEventListener("resize", () => { if (answer) draw(); });

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
