// Charts, drawn from the data that the page brings along, and the search through the options.
(() => {
  'use strict';
  const data = JSON.parse(document.getElementById('report-data').textContent);
  const palette = ['#0f7b8a', '#d9622b', '#6a5acd', '#3c8d40', '#b8336a', '#a07a10', '#4878b8',
                   '#7a7a7a'];
  const dashes = ['none', '7 3', '2 3'];  // of each further set of colours
  const dashOf = (index) => Math.floor(index / palette.length) % dashes.length;
  const margin = {left: 56, right: 16, top: 12, bottom: 44};

  function add(parent, name, attributes = {}, text = '') {
    const element = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text) element.textContent = text;
    parent.append(element);
    return element;
  }
  function addHtml(parent, name, className, text = '') {
    const element = document.createElement(name);
    element.className = className;
    element.textContent = text;
    parent.append(element);
    return element;
  }

  const compact = (value) => new Intl.NumberFormat('en', {
    notation: Math.abs(value) >= 1e4 ? 'compact' : 'standard', maximumSignificantDigits: 4,
  }).format(value);
  const exact = (value) =>
    new Intl.NumberFormat('en', {maximumSignificantDigits: 7}).format(value);

  function linearTicks(low, high, count) {
    const rough = (high - low) / count;
    const decade = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((digit) => digit * decade).find((value) => value >= rough);
    const ticks = [];
    for (let i = Math.ceil(low / step); i * step <= high + 1e-9 * step; ++i) ticks.push(i * step);
    return ticks;
  }
  function logTicks(low, high) {
    const decades = Math.log10(high / low);
    const digits = decades > 4 ? [1] : [1, 2, 5];
    const ticks = [];
    for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e) {
      for (const digit of digits) ticks.push(digit * 10 ** e);
    }
    return ticks.filter((tick) => tick >= low * 0.999 && tick <= high * 1.001);
  }

  function makeLogAxis(low, high, from, to) {
    const toPx = (value) => value > 0
      ? from + (to - from) * Math.log(value / low) / Math.log(high / low) : NaN;
    return {toPx, ticks: logTicks(low, high)};
  }

  // An axis for values: toPx() maps them to [from, to]; values it has no place for give NaN.
  function makeAxis(values, from, to) {
    const positive = values.filter((value) => value > 0);
    let low = Math.min(...values);
    let high = Math.max(...values);
    const isLog = low >= 0 && positive.length > 1 && high / Math.min(...positive) > 100;
    if (isLog) return makeLogAxis(Math.min(...positive), high, from, to);
    if (low === high) [low, high] = [low - 1, high + 1];
    const toPx = (value) => from + (to - from) * (value - low) / (high - low);
    return {toPx, ticks: linearTicks(low, high, Math.max(2, Math.abs(to - from) / 50))};
  }

  // An empty drawing as wide as its box, which replaces the one before.
  function makeDrawing(box, label) {
    box.querySelectorAll('svg').forEach((old) => old.remove());
    const width = Math.max(box.clientWidth, 200);
    const height = Math.round(Math.min(300, Math.max(220, 0.6 * width)));
    const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    svg.setAttribute('width', width);
    svg.setAttribute('height', height);
    svg.setAttribute('role', 'img');
    svg.setAttribute('aria-label', label);
    box.prepend(svg);
    return {svg, width, height, bottom: height - margin.bottom, right: width - margin.right};
  }

  function drawHorizontalGrid(drawing, axis, format) {
    for (const tick of axis.ticks) {
      const y = axis.toPx(tick);
      add(drawing.svg, 'line',
          {class: 'gridline', x1: margin.left, x2: drawing.right, y1: y, y2: y});
      add(drawing.svg, 'text', {x: margin.left - 8, y: y + 4, 'text-anchor': 'end'}, format(tick));
    }
  }
  function drawLabelBelow(drawing, label) {
    add(drawing.svg, 'text', {class: 'label', x: (margin.left + drawing.right) / 2,
                              y: drawing.height - 6, 'text-anchor': 'middle'}, label);
  }

  // Text beside (x, y) of the drawing, within its box.
  function showTip(box, tip, lines, x, y) {
    tip.replaceChildren();
    for (const line of lines) addHtml(tip, 'div', '', line);
    tip.hidden = false;
    const left = Math.min(Math.max(x - tip.offsetWidth / 2, 0), box.clientWidth - tip.offsetWidth);
    tip.style.left = `${left}px`;
    tip.style.top = `${y > tip.offsetHeight + 14 ? y - tip.offsetHeight - 12 : y + 14}px`;
  }

  // Calls draw() now and whenever the width changes; it returns targets {x, y, lines}. Pointer and
  // arrow keys choose the one to explain.
  function makeChart(box, draw, nearest) {
    const tip = addHtml(box, 'div', 'tip');
    tip.setAttribute('role', 'status');
    tip.hidden = true;
    box.tabIndex = 0;
    let targets = [];
    let current = -1;
    const show = (index) => {
      current = index;
      box.querySelectorAll('.chosen').forEach((element) => element.classList.remove('chosen'));
      tip.hidden = index < 0;
      if (index < 0) return;
      const target = targets[index];
      target.mark.classList.add('chosen');
      showTip(box, tip, target.lines, target.x, target.y);
    };
    const redraw = () => {
      targets = draw();
      show(-1);
    };
    box.addEventListener('pointermove', (event) => {
      const corner = box.getBoundingClientRect();
      const [x, y] = [event.clientX - corner.left, event.clientY - corner.top];
      let best = -1;
      targets.forEach((target, index) => {
        if (best < 0 || nearest(target, x, y) < nearest(targets[best], x, y)) best = index;
      });
      show(best);
    });
    box.addEventListener('pointerleave', () => show(-1));
    box.addEventListener('blur', () => show(-1));
    box.addEventListener('keydown', (event) => {
      const step = {ArrowLeft: -1, ArrowRight: 1}[event.key];
      if (!step || !targets.length || event.target !== box) return;
      event.preventDefault();
      show(current < 0 ? 0 : Math.min(Math.max(current + step, 0), targets.length - 1));
    });
    let width = 0;
    new ResizeObserver(() => {
      if (box.clientWidth === width) return;
      width = box.clientWidth;
      redraw();
    }).observe(box);
    return redraw;
  }

  function addSwitch(box, name, choices, onChange) {
    const group = document.createElement('div');
    group.className = 'switch';
    choices.forEach((choice, index) => {
      const label = addHtml(group, 'label', '');
      const input = document.createElement('input');
      input.type = 'radio';
      input.name = name;
      input.checked = index === 0;
      input.addEventListener('change', () => onChange(index));
      label.append(input, choice);
    });
    box.before(group);
  }

  function addLegend(box, curves) {
    const legend = document.createElement('ul');
    legend.className = 'legend';
    curves.forEach((curve, index) => {
      const item = addHtml(legend, 'li', '', curve.label);
      item.style.setProperty('--color', palette[index % palette.length]);
      if (dashOf(index)) item.className = `dash${dashOf(index)}`;
    });
    box.after(legend);
  }

  function drawCurve(drawing, points, color, index) {
    add(drawing.svg, 'polyline', {class: 'curve', stroke: color,
                                  'stroke-dasharray': dashes[dashOf(index)],
                                  points: points.map(({x, y}) => `${x},${y}`).join(' ')});
  }

  const distanceTo = (target, x, y) => Math.hypot(target.x - x, target.y - y);

  function plotChart(box, plot, number) {
    const overWhat = ['seconds', 'iterations'];
    let column = 0;
    const draw = () => {
      const finite = plot.curves.map((curve) => curve.points.filter(
          (point) => Number.isFinite(point[column]) && Number.isFinite(point[2])));
      const all = finite.flat();
      if (!all.length) return [];
      const drawing =
          makeDrawing(box, `${plot.title}: ${plot.valueLabel} over ${overWhat[column]}`);
      const xAxis = makeAxis(all.map((point) => point[column]), margin.left + 8, drawing.right - 8);
      const yAxis = makeAxis(all.map((point) => point[2]), drawing.bottom - 8, margin.top + 8);
      drawHorizontalGrid(drawing, yAxis, compact);
      for (const tick of xAxis.ticks) {
        add(drawing.svg, 'text', {x: xAxis.toPx(tick), y: drawing.bottom + 18,
                                  'text-anchor': 'middle'}, compact(tick));
      }
      drawLabelBelow(drawing, overWhat[column]);
      const targets = [];
      finite.forEach((points, index) => {
        const color = palette[index % palette.length];
        const onScreen = points
            .map((point) => ({point, x: xAxis.toPx(point[column]), y: yAxis.toPx(point[2])}))
            .filter(({x, y}) => Number.isFinite(x) && Number.isFinite(y));
        drawCurve(drawing, onScreen, color, index);
        const radius = onScreen.length > 40 ? 1.5 : 3.5;
        for (const {point, x, y} of onScreen) {
          const mark = add(drawing.svg, 'circle', {cx: x, cy: y, r: radius, fill: color});
          const seconds = point[0] === null ? '?' : point[0].toFixed(3);
          const lines = [plot.curves[index].label, `${plot.valueLabel} ${exact(point[2])}`,
                         `${seconds} s, iteration ${point[1]}`];
          targets.push({x, y, lines, mark});
        }
      });
      return targets;
    };
    const redraw = makeChart(box, draw, distanceTo);
    addSwitch(box, `plot-${number}`, ['Seconds', 'Iterations'], (index) => {
      column = index;
      redraw();
    });
    addLegend(box, plot.curves);
  }

  // Values of a few stages, on a logarithmic axis.
  function stageChart(box, plot) {
    const {stages, curves} = plot;
    const draw = () => {
      const positive = curves.flatMap((curve) => curve.values.filter((value) => value > 0));
      if (!positive.length) return [];
      const drawing = makeDrawing(box, `${plot.title}: ${plot.valueLabel} by stage`);
      const yAxis = makeLogAxis(Math.min(...positive) / 1.5, Math.max(...positive) * 1.5,
                                drawing.bottom, margin.top);
      drawHorizontalGrid(drawing, yAxis, compact);
      drawLabelBelow(drawing, plot.valueLabel);
      const step = (drawing.right - margin.left) / stages.length;
      const xOf = (index) => margin.left + (index + 0.5) * step;
      stages.forEach((stage, index) => {
        add(drawing.svg, 'text', {x: xOf(index), y: drawing.bottom + 18, 'text-anchor': 'middle'},
            stage);
      });
      const targets = [];
      curves.forEach((curve, number) => {
        const color = palette[number % palette.length];
        const onScreen = curve.values
            .map((value, index) => ({value, index, x: xOf(index), y: yAxis.toPx(value)}))
            .filter(({value}) => value > 0);
        drawCurve(drawing, onScreen, color, number);
        for (const {value, index, x, y} of onScreen) {
          const mark = add(drawing.svg, 'circle', {cx: x, cy: y, r: 3.5, fill: color});
          const lines = [`${stages[index]}, ${curve.label}`, `${exact(value)} ${plot.valueLabel}`];
          targets.push({x, y, lines, mark});
        }
      });
      return targets;
    };
    makeChart(box, draw, distanceTo);
    addLegend(box, curves);
  }

  function histogramChart(box, histogram) {
    const {lowerEdges, counts} = histogram;
    const total = Math.max(1, counts.reduce((sum, count) => sum + count, 0));
    const draw = () => {
      const drawing = makeDrawing(box, `${histogram.title}, ${histogram.xLabel}`);
      const shares = counts.map((count) => 100 * count / total);
      const highest = Math.max(...shares, 1e-9);
      const yAxis = {
        toPx: (share) => drawing.bottom - (drawing.bottom - margin.top) * share / highest,
        ticks: linearTicks(0, highest, 4),
      };
      drawHorizontalGrid(drawing, yAxis, (tick) => `${compact(tick)} %`);
      drawLabelBelow(drawing, histogram.xLabel);
      const width = (drawing.right - margin.left) / counts.length;
      const every = Math.ceil(34 / width);
      return counts.map((count, i) => {
        const left = margin.left + i * width;
        const top = yAxis.toPx(shares[i]);
        const mark = add(drawing.svg, 'rect', {class: 'bin', x: left + 1, y: top, rx: 1.5,
                                               width: Math.max(width - 2, 1),
                                               height: Math.max(drawing.bottom - top, 0)});
        if (i % every === 0) {
          add(drawing.svg, 'text', {x: left, y: drawing.bottom + 18, 'text-anchor': 'middle'},
              compact(lowerEdges[i]));
        }
        const range = i + 1 < counts.length ? `${lowerEdges[i]} to ${lowerEdges[i + 1]}`
                                            : `${lowerEdges[i]} and more`;
        return {x: left + width / 2, y: top, mark,
                lines: [range, `${exact(count)} points, ${shares[i].toFixed(2)} %`]};
      });
    };
    makeChart(box, draw, (target, x) => Math.abs(target.x - x));
  }

  document.querySelectorAll('[data-plot]').forEach((box) => {
    plotChart(box, data.plots[box.dataset.plot], box.dataset.plot);
  });
  document.querySelectorAll('[data-stage-plot]').forEach((box) => {
    stageChart(box, data.stagePlots[box.dataset.stagePlot]);
  });
  document.querySelectorAll('[data-histogram]').forEach((box) => {
    histogramChart(box, data.histograms[box.dataset.histogram]);
  });

  const search = document.getElementById('option-search');
  if (search) {
    const rows = [...document.querySelectorAll('.options tbody tr')];
    search.addEventListener('input', () => {
      const words = search.value.toLowerCase().split(/\s+/);
      for (const row of rows) {
        const text = row.textContent.toLowerCase();
        row.hidden = !words.every((word) => text.includes(word));
      }
      const shown = rows.filter((row) => !row.hidden).length;
      document.getElementById('option-matches').textContent =
          search.value ? `${shown} of ${rows.length} options` : '';
    });
  }
})();
