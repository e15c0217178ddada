// Maps laid over each other by their place in the world, parted by a divider that can be dragged.
(() => {
  'use strict';
  const stage = document.getElementById('stage');
  if (!stage) return;
  const byId = (id) => document.getElementById(id);
  const divide = byId('divide');
  const divider = byId('divider');

  const layers = Array.from(stage.querySelectorAll('img.layer'), (image) => {
    const number = (name) => Number(image.dataset[name]);
    return {
      image,
      name: image.dataset.name,
      leftM: number('leftM'),
      topM: number('topM'),
      pixelM: number('pixelM'),
      leftPx: number('leftPx'),  // of the map's area in the picture, which has margins
      topPx: number('topPx'),
      widthPx: number('widthPx'),
      heightPx: number('heightPx'),
    };
  });
  const chosen = {left: 0, right: layers.length - 1};

  // World position of the stage's upper left corner [m], and magnification [CSS px per m].
  const view = {left: 0, top: 0, scale: 1};
  let fitScale = 1;
  let pointer = null;  // where the mouse or the last finger is, in the stage [px]

  const worldX = (x) => view.left + x / view.scale;
  const worldY = (y) => view.top - y / view.scale;

  function fit() {
    const target = layers[chosen.right];
    const width = target.widthPx * target.pixelM;
    const height = target.heightPx * target.pixelM;
    const box = {width: stage.clientWidth, height: stage.clientHeight};
    fitScale = view.scale = Math.min(box.width / width, box.height / height);
    view.left = target.leftM - (box.width / view.scale - width) / 2;
    view.top = target.topM + (box.height / view.scale - height) / 2;
    render();
  }

  // Zooms such that the world stays where it is at (x, y) of the stage.
  function zoomAt(x, y, factor) {
    const finest = Math.min(...layers.map((layer) => layer.pixelM));
    const scale = Math.min(Math.max(view.scale * factor, fitScale / 8), 48 / finest);
    view.left += x / view.scale - x / scale;
    view.top -= y / view.scale - y / scale;
    view.scale = scale;
    render();
  }
  const zoomAtCenter = (factor) => zoomAt(stage.clientWidth / 2, stage.clientHeight / 2, factor);

  function pan(dx, dy) {
    view.left -= dx / view.scale;
    view.top += dy / view.scale;
    render();
  }

  // Shows a layer between two columns of the stage [px], without the margins of its picture.
  function place(layer, from, to) {
    const zoom = view.scale * layer.pixelM;
    const x = (layer.leftM - view.left) * view.scale - layer.leftPx * zoom;
    const y = (view.top - layer.topM) * view.scale - layer.topPx * zoom;
    const right = layer.leftPx + layer.widthPx;
    const clamp = (column) => Math.min(Math.max((column - x) / zoom, layer.leftPx), right);
    const [left, end] = [clamp(from), clamp(to)];
    const [top, bottom] = [layer.topPx, layer.topPx + layer.heightPx];
    const style = layer.image.style;
    style.transform = `translate(${x}px, ${y}px) scale(${zoom})`;
    style.clipPath = 'polygon(' + [[left, top], [end, top], [end, bottom], [left, bottom]]
        .map(([px, py]) => `${px.toFixed(2)}px ${py}px`).join(', ') + ')';
    // Large pixels are data, and the eye should see where one ends.
    style.imageRendering = zoom * devicePixelRatio > 3 ? 'pixelated' : 'auto';
    style.visibility = 'visible';
  }

  function renderScale() {
    const room = Math.min(140, stage.clientWidth / 4) / view.scale;
    const decade = 10 ** Math.floor(Math.log10(room));
    const length = [5, 2, 1].map((digit) => digit * decade).find((value) => value <= room);
    byId('scale-bar').style.width = `${length * view.scale}px`;
    byId('scale-label').textContent =
        length < 1 ? `${Number((100 * length).toPrecision(3))} cm` : `${length} m`;
  }

  function renderPosition() {
    const at = pointer || {x: stage.clientWidth / 2, y: stage.clientHeight / 2};
    const digits = view.scale > 200 ? 3 : 2;
    const text = (value) => value.toFixed(digits).replace('-', '\u2212');
    byId('position').textContent = `x ${text(worldX(at.x))} m, y ${text(worldY(at.y))} m`;
  }

  function render() {
    const width = stage.clientWidth;
    const at = width * divide.value / 100;
    for (const layer of layers) layer.image.style.visibility = 'hidden';
    if (chosen.left === chosen.right) {
      place(layers[chosen.right], 0, width);
    } else {
      place(layers[chosen.left], 0, at);
      place(layers[chosen.right], at, width);
    }
    const single = chosen.left === chosen.right;
    divider.hidden = single;
    divider.style.left = `${at}px`;
    byId('name-left').textContent = single ? '' : layers[chosen.left].name;
    byId('name-right').textContent = layers[chosen.right].name;
    renderScale();
    renderPosition();
  }

  function setDivide(x) {
    divide.value = 100 * Math.min(Math.max(x / stage.clientWidth, 0), 1);
    render();
  }

  function inStage(event) {
    const box = stage.getBoundingClientRect();
    return {x: event.clientX - box.left - stage.clientLeft,
            y: event.clientY - box.top - stage.clientTop};
  }

  // One finger or the mouse moves the map, two zoom it. A finger on the divider moves that.
  const fingers = new Map();
  let onDivider = null;  // id of the pointer that holds it
  let travelled = 0;     // of the only finger since it went down [px]
  let lastTap = null;

  function pinch(id, to) {
    const [other] = [...fingers].filter(([key]) => key !== id).map(([, at]) => at);
    const from = fingers.get(id);
    const distance = (at) => Math.hypot(at.x - other.x, at.y - other.y);
    pan((to.x - from.x) / 2, (to.y - from.y) / 2);
    zoomAt((to.x + other.x) / 2, (to.y + other.y) / 2,
           Math.max(distance(to), 1) / Math.max(distance(from), 1));
  }

  function onTap(event, at) {
    const isSecond = lastTap && event.timeStamp - lastTap.time < 350 &&
        Math.hypot(at.x - lastTap.x, at.y - lastTap.y) < 30;
    if (isSecond) zoomAt(at.x, at.y, event.shiftKey ? 0.5 : 2);
    lastTap = isSecond ? null : {x: at.x, y: at.y, time: event.timeStamp};
  }

  stage.addEventListener('pointerdown', (event) => {
    if (event.target.closest('button') || event.button !== 0) return;
    stage.setPointerCapture(event.pointerId);
    if (event.target.closest('.divider')) {
      onDivider = event.pointerId;
    } else if (fingers.size < 2) {
      fingers.set(event.pointerId, inStage(event));
      travelled = fingers.size === 1 ? 0 : Infinity;
    }
  });
  stage.addEventListener('pointermove', (event) => {
    const to = inStage(event);
    pointer = to;
    const from = fingers.get(event.pointerId);
    if (event.pointerId === onDivider) {
      setDivide(to.x);
    } else if (!from) {
      renderPosition();
    } else {
      if (fingers.size === 2) {
        pinch(event.pointerId, to);
      } else {
        travelled += Math.hypot(to.x - from.x, to.y - from.y);
        pan(to.x - from.x, to.y - from.y);
      }
      fingers.set(event.pointerId, to);
    }
  });
  function release(event) {
    if (event.pointerId === onDivider) onDivider = null;
    if (fingers.delete(event.pointerId) && event.type === 'pointerup' && travelled < 6) {
      onTap(event, inStage(event));
    }
  }
  stage.addEventListener('pointerup', release);
  stage.addEventListener('pointercancel', release);
  stage.addEventListener('pointerleave', () => {
    pointer = null;
    renderPosition();
  });
  stage.addEventListener('wheel', (event) => {
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === 1 ? 30 : 1);
    const at = inStage(event);
    zoomAt(at.x, at.y, Math.exp(-Math.min(Math.max(pixels, -300), 300) / 400));
  }, {passive: false});

  stage.addEventListener('keydown', (event) => {
    if (event.target !== stage || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = Math.min(stage.clientWidth, stage.clientHeight) / 8;
    const actions = {
      ArrowLeft: () => pan(step, 0),
      ArrowRight: () => pan(-step, 0),
      ArrowUp: () => pan(0, step),
      ArrowDown: () => pan(0, -step),
      '+': () => zoomAtCenter(1.5),
      '=': () => zoomAtCenter(1.5),
      '-': () => zoomAtCenter(1 / 1.5),
      0: fit,
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  });

  byId('zoom-in').addEventListener('click', () => zoomAtCenter(1.5));
  byId('zoom-out').addEventListener('click', () => zoomAtCenter(1 / 1.5));
  byId('zoom-reset').addEventListener('click', fit);
  divide.addEventListener('input', render);

  for (const side of ['left', 'right']) {
    const select = byId(`map-${side}`);
    layers.forEach((layer, index) => select.add(new Option(layer.name, index)));
    select.value = chosen[side];
    select.addEventListener('change', () => {
      chosen[side] = Number(select.value);
      render();
    });
  }

  // The stage takes the shape of the final map, within what a screen can show.
  const final = layers[chosen.right];
  stage.style.aspectRatio = `${final.widthPx} / ${final.heightPx}`;
  fit();
  let width = stage.clientWidth;
  new ResizeObserver(() => {
    if (stage.clientWidth === width) return;
    width = stage.clientWidth;
    fit();
  }).observe(stage);
})();
