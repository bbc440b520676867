"use strict";
// Draws what moves into pictures, as the slider of the load steps is moved.
(async function () {
  const slider = document.getElementById("view-step");
  const packed = document.getElementById("steps-data");
  if (!slider || !packed || typeof DecompressionStream === "undefined") return;
  const bytes = Uint8Array.from(atob(packed.textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const data = JSON.parse(await new Response(stream).text());
  const last = Number(slider.max);
  const live = [];

  // Put a canvas over each picture that follows the slider; others of the fields stay as they are.
  function prepare() {
    document.querySelectorAll("#pictures figure img").forEach((image) => {
      const own = data.pictures.find((one) => one.file === image.dataset.file);
      if (!own) {
        if (data.ofTheEnd.includes(image.dataset.file)) image.parentNode.classList.add("of-the-end");
        return;
      }
      const place = document.createElement("div");
      place.className = "live";
      image.replaceWith(place);
      const canvas = document.createElement("canvas");
      place.append(image, canvas);
      if (own.frame) image.src = own.frame;
      live.push({ own: own, image: image, canvas: canvas });
      new ResizeObserver(() => draw(live.find((one) => one.canvas === canvas))).observe(canvas);
    });
  }

  function kindsOf(own) { return own.kinds || []; }

  // A panel: from its numbers to the canvas.
  function panelOf(panel, canvas, point) {
    const [left, top, width, height] = panel.box;
    const box = { x: left * canvas.width, y: top * canvas.height };
    box.width = width * canvas.width;
    box.height = height * canvas.height;
    return {
      box: box, point: point,
      x: (value) => box.x + ((value - panel.x[0]) / (panel.x[1] - panel.x[0])) * box.width,
      y: (value) => box.y + ((panel.y[1] - value) / (panel.y[1] - panel.y[0])) * box.height,
    };
  }

  function draw(one) {
    const { own, canvas } = one;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width === 0) return;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const pen = canvas.getContext("2d");
    const step = Number(slider.value);
    own.panels.forEach((panel) => {
      const at = panelOf(panel, canvas, canvas.width / own.width);
      pen.save();
      pen.beginPath();
      pen.rect(at.box.x, at.box.y, at.box.width, at.box.height);
      pen.clip();
      panel.layers.forEach((layer) => layers[layer.type](pen, at, layer, step, kindsOf(own)));
      pen.restore();
    });
    canvas.dataset.step = String(step);
  }

  function mark(pen, x, y, size, kind, point, isFilled) {
    pen.beginPath();
    if (kind.shape === "s") pen.rect(x - size / 2, y - size / 2, size, size);
    else pen.arc(x, y, size / 2, 0, 2 * Math.PI);
    pen.fillStyle = isFilled || kind.filled ? kind.colour : "white";
    pen.fill();
    pen.strokeStyle = kind.edge;
    pen.lineWidth = (isFilled ? 0.3 : 0.8) * point;
    pen.stroke();
  }

  function path(pen, at, xs, ys, breaks) {
    pen.beginPath();
    let isOn = false;
    xs.forEach((x, n) => {
      if (ys[n] === null) { isOn = false; return; }
      if (isOn && !breaks.includes(n)) pen.lineTo(at.x(x), at.y(ys[n]));
      else pen.moveTo(at.x(x), at.y(ys[n]));
      isOn = true;
    });
    pen.stroke();
  }

  function arrow(pen, x, y, u, v, thick) {
    const size = Math.hypot(u, v);
    const head = Math.min(5 * thick, size);
    const [a, b] = [u / size, v / size];
    const along = (t, side) => [x + t * a - side * b, y + t * b + side * a];
    const corners = [
      along(0, thick / 2), along(size - head, thick / 2), along(size - head, 1.5 * thick),
      along(size, 0), along(size - head, -1.5 * thick), along(size - head, -thick / 2),
      along(0, -thick / 2),
    ];
    pen.beginPath();
    corners.forEach((corner, n) => (n ? pen.lineTo(...corner) : pen.moveTo(...corner)));
    pen.closePath();
  }

  const colours = data.colours.map((text) => [1, 3, 5].map((n) => parseInt(text.slice(n, n + 2), 16)));
  function shade(layer, value) {
    const share = (value - layer.low) / (layer.high - layer.low);
    return Math.max(0, Math.min(colours.length - 1, Math.round(share * (colours.length - 1))));
  }
  // Each pixel has the value between those of its triangle's corners.
  function fill(pixels, corners, values, layer) {
    const [[ax, ay], [bx, by], [cx, cy]] = corners;
    const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (area === 0) return;
    const [xs, ys] = [[ax, bx, cx], [ay, by, cy]];
    const first = Math.max(0, Math.floor(Math.min(...xs)));
    const end = Math.min(pixels.width - 1, Math.ceil(Math.max(...xs)));
    const bottom = Math.min(pixels.height - 1, Math.ceil(Math.max(...ys)));
    for (let y = Math.max(0, Math.floor(Math.min(...ys))); y <= bottom; y++) {
      for (let x = first; x <= end; x++) {
        const [px, py] = [x + 0.5, y + 0.5];
        const b = ((px - ax) * (cy - ay) - (cx - ax) * (py - ay)) / area;
        const c = ((bx - ax) * (py - ay) - (px - ax) * (by - ay)) / area;
        if (b < -1e-3 || c < -1e-3 || b + c > 1.001) continue;
        const value = values[0] + b * (values[1] - values[0]) + c * (values[2] - values[0]);
        const place = 4 * (y * pixels.width + x);
        pixels.data.set(colours[shade(layer, value)], place);
        pixels.data[place + 3] = 255;
      }
    }
  }

  const layers = {
    curve(pen, at, layer, step, kinds) {
      const [ys, marks] = [layer.y[step], layer.kinds[step]];
      pen.strokeStyle = "#999999";
      pen.lineWidth = 0.7 * at.point;
      path(pen, at, layer.x, ys, layer.breaks);
      pen.strokeStyle = "#4d4d4d";
      pen.lineWidth = 1.2 * at.point;
      pen.setLineDash([1.2 * at.point, 2 * at.point]);
      layer.bounds[step].forEach((bound) => path(pen, at, layer.x, bound, layer.breaks));
      pen.setLineDash([]);
      const size = (layer.x.length < 60 ? 3.5 : 2.5) * at.point;
      layer.x.forEach((x, n) => {
        if (ys[n] !== null) mark(pen, at.x(x), at.y(ys[n]), size, kinds[marks[n]], at.point, false);
      });
    },
    strip(pen, at, layer, step, kinds) {
      layer.runs[step].forEach(([start, end, kind]) => {
        pen.fillStyle = kinds[kind].colour;
        pen.fillRect(at.x(start), at.box.y, at.x(end) - at.x(start), at.box.height);
      });
    },
    marks(pen, at, layer, step, kinds) {
      layer.x.forEach((x, n) => {
        const kind = layer.kinds[step][n];
        const size = layer.sizes[kind] * at.point;
        mark(pen, at.x(x), at.y(layer.y[n]), size, kinds[kind], at.point, true);
      });
    },
    colours(pen, at, layer, step) {
      const [width, height] = [Math.ceil(at.box.width), Math.ceil(at.box.height)];
      const values = layer.values[step];
      if (layer.triangles.length === 0) {  // nothing but points is known
        layer.x.forEach((x, n) => {
          pen.fillStyle = "rgb(" + colours[shade(layer, values[n])].join(",") + ")";
          pen.fillRect(at.x(x) - 2 * at.point, at.y(layer.y[n]) - 2 * at.point, 4 * at.point, 4 * at.point);
        });
        return;
      }
      const pixels = pen.createImageData(width, height);
      for (let n = 0; n < layer.triangles.length; n += 3) {
        const three = [0, 1, 2].map((corner) => [
          at.x(layer.corners[2 * (n + corner)]) - at.box.x,
          at.y(layer.corners[2 * (n + corner) + 1]) - at.box.y,
        ]);
        const own = [0, 1, 2].map((corner) => values[layer.triangles[n + corner]]);
        fill(pixels, three, own, layer);
      }
      const aside = document.createElement("canvas");
      aside.width = width;
      aside.height = height;
      aside.getContext("2d").putImageData(pixels, 0, 0);
      pen.drawImage(aside, at.box.x, at.box.y);
    },
    arrows(pen, at, layer, step) {
      const from = layer.at[step];
      const scale = (layer.longest * at.box.width) / layer.most;
      const thick = layer.width * at.box.width;
      for (let n = 0; n < from.length; n += 4) {
        const [x, y, u, v] = from.slice(n, n + 4);
        if (Math.hypot(u, v) === 0) continue;
        arrow(pen, at.x(x), at.y(y), scale * u, -scale * v, thick);
        if (layer.colour === "white") {
          pen.strokeStyle = "#262626";
          pen.lineWidth = 0.8 * at.point;
          pen.stroke();
        }
        pen.fillStyle = layer.colour;
        pen.fill();
      }
    },
    time(pen, at, layer, step) {
      const x = at.x(layer.x[step]);
      pen.strokeStyle = data.marker;
      pen.lineWidth = 1.2 * at.point;
      pen.beginPath();
      pen.moveTo(x, at.box.y);
      pen.lineTo(x, at.box.y + at.box.height);
      pen.stroke();
    },
    dot(pen, at, layer, step) {
      const look = { shape: "o", colour: data.marker, edge: "white", filled: true };
      mark(pen, at.x(layer.x[step]), at.y(layer.y[step]), 6 * at.point, look, at.point, false);
    },
  };

  slider.addEventListener("input", () => {
    if (live.length === 0) prepare();
    document.body.classList.toggle("earlier", Number(slider.value) < last);
    live.forEach(draw);
  });
})();
