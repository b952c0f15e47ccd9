// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Curves over frames or anything else, drawn by uPlot in the colors of the page.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { figure } from './numbers.js';
import { styleValue } from './dom.js';
import { isStroked, markerPath } from './look.js';

/** Log scales need something above zero; a curve of all zeros has nothing. */
function suitsLog(series) {
  const values = series.flatMap((s) => s.y).filter((y) => y !== null && y !== undefined);
  const above = values.filter((y) => y > 0);
  return above.length > 0 && above.length === values.length && Math.max(...above) / Math.min(...above) > 20;
}

/** All x of several series in one ascending list, and each series' y along it. */
function aligned(series) {
  const xs = [...new Set(series.flatMap((s) => s.x))].sort((a, b) => a - b);
  const place = new Map(xs.map((x, i) => [x, i]));
  const rows = series.map((s) => {
    const row = new Array(xs.length).fill(null);
    s.x.forEach((x, i) => (row[place.get(x)] = s.y[i] ?? null));
    return row;
  });
  return [xs, ...rows];
}

/** Strokes that hang from a line: from each hatched point half way to its neighbors. */
function hatch(hatched, known, at, scale) {
  const apart = 5 * scale;
  const path = new Path2D();
  let rest = 0;
  for (let i = 0; i + 1 < hatched.length; ++i) {
    if (!known(i) || !known(i + 1) || !(hatched[i] || hatched[i + 1])) continue;
    const [x, y] = at(i);
    const [dx, dy] = at(i + 1).map((to, k) => to - (k === 0 ? x : y));
    const size = Math.hypot(dx, dy);
    const end = hatched[i + 1] ? size : 0.5 * size;
    let along = hatched[i] ? apart - rest : 0.5 * size + apart;
    for (; along <= end; along += apart) {
      const [px, py] = [x + (dx * along) / size, y + (dy * along) / size];
      path.moveTo(px, py);
      path.lineTo(px - 3 * scale, py + 6 * scale);
    }
    rest = Math.max(0, end - (along - apart));
  }
  return path;
}

export class Curves {
  /**
   * content: {series: [{name, x, y, color, strong, dash, marker, hollow, dots, hatched}], xLabel, yLabel, log, frames: whether x is the frame,
   * names: of x = 0, 1, 2 …, when these are kinds and not numbers}.
   * onframe(frame): the reader pressed or dragged there.
   */
  constructor(place, height, onframe) {
    Object.assign(this, { place, height, onframe, frame: 0 });
    new ResizeObserver(() => {
      const width = this.place.clientWidth;
      if (this.plot && width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: this.height });
      else if (!this.plot && this.content) this.draw(this.content);
    }).observe(place);
    this.inSight = true;
    new IntersectionObserver(([entry]) => {
      this.inSight = entry.isIntersecting;
      if (this.inSight && this.stale) this.plot?.redraw(false, false);
      if (this.inSight) this.stale = false;
    }).observe(place);
  }

  draw(content) {
    this.content = content;
    this.plot?.destroy();
    this.plot = null;
    const width = this.place.clientWidth;
    if (width === 0) return;
    const log = content.log === undefined ? false : content.log === 'auto' ? suitsLog(content.series) : content.log;
    // Zeros have no place on a log scale: they leave a hole there.
    const data = aligned(content.series);
    if (log) for (let i = 1; i < data.length; ++i) data[i] = data[i].map((y) => (y > 0 ? y : null));
    const font = '11px ' + styleValue('--sans');
    // A log scale shows only the powers of ten.
    const decades = (_, splits) => splits.map((v) => (Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9 ? v : null));
    const axis = (label, more) => ({
      stroke: styleValue('--muted'),
      font,
      labelFont: font,
      label,
      labelSize: label ? 18 : 0,
      labelGap: 0,
      gap: 4,
      ticks: { show: false },
      grid: { stroke: styleValue('--line'), width: 1 },
      ...more,
    });
    const ranges = log ? {} : { range: (_, low, high) => [Math.min(0, low ?? 0), (high ?? 0) > 0 ? high * 1.06 : 1] };
    const { names } = content;
    const kinds = { splits: () => names.map((_, i) => i), values: () => names, space: 1 };
    const numbers = { space: 44, incrs: content.frames ? [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000] : undefined };
    this.plot = new uPlot(
      {
        width,
        height: this.height,
        padding: [8, 8, 0, 0],
        legend: { show: false },
        cursor: { x: false, y: false, drag: { x: false, y: false }, points: { show: false } },
        scales: { x: { time: false, ...(names ? { range: [-0.3, names.length - 0.7] } : {}) }, y: { distr: log ? 3 : 1, ...ranges } },
        axes: [
          axis(content.xLabel, { size: 24, ...(names ? kinds : numbers) }),
          axis(content.yLabel, { size: 46, ...(log ? { filter: decades, grid: { stroke: styleValue('--line'), width: 1, filter: decades } } : {}), space: log ? 18 : 28, values: (_, splits) => splits.map((v) => (v === null ? '' : figure(v))) }),
        ],
        series: [
          {},
          ...content.series.map((s) => ({
            label: s.name,
            stroke: s.color,
            width: s.strong ? 2.4 : 1.3,
            dash: s.dash?.length ? s.dash : undefined,
            points: { show: !s.marker && (names !== undefined || s.x.length === 1), size: 6, fill: s.color },
            ...(s.dots ? { paths: () => null } : {}),
            spanGaps: false,
          })),
        ],
        hooks: { draw: [(plot) => this.drawMarks(plot), (plot) => this.drawFrame(plot)] },
      },
      data,
      this.place,
    );
    if (content.frames) this.watch(this.plot);
  }

  /** Markers where lines end and at single points; hatch below lines where surface is uncovered. */
  drawMarks(plot) {
    const scale = devicePixelRatio || 1;
    const { ctx } = plot;
    const [xs] = plot.data;
    ctx.save();
    ctx.setLineDash([]);
    this.content.series.forEach((s, k) => {
      const row = plot.data[k + 1];
      const at = (i) => [plot.valToPos(xs[i], 'x', true), plot.valToPos(row[i], 'y', true)];
      const known = (i) => i < row.length && row[i] !== null && row[i] !== undefined;
      ctx.strokeStyle = s.color;
      if (s.hatched?.length) {
        const hatched = new Map(s.x.map((x, i) => [x, s.hatched[i] === true]));
        ctx.lineWidth = 0.8 * scale;
        ctx.stroke(hatch(xs.map((x) => hatched.get(x)), known, at, scale));
      }
      if (!s.marker) return;
      xs.forEach((_, i) => {
        if (!known(i) || (known(i + 1) && !s.dots && !this.content.names)) return;
        const path = new Path2D(markerPath(s.marker, ...at(i), 3.8 * scale));
        const stroked = isStroked(s.marker);
        ctx.fillStyle = s.hollow ? styleValue('--panel') : s.color;
        ctx.lineWidth = (stroked ? 2 : 1.3) * scale;
        if (!stroked) ctx.fill(path);
        if (stroked || s.hollow) ctx.stroke(path);
      });
    });
    ctx.restore();
  }

  watch(plot) {
    const go = (event) => {
      const { left } = plot.over.getBoundingClientRect();
      const xs = plot.data[0];
      const x = Math.round(plot.posToVal(event.clientX - left, 'x'));
      this.onframe(Math.min(Math.max(x, xs[0]), xs[xs.length - 1]));
    };
    plot.over.style.cursor = 'ew-resize';
    plot.over.style.touchAction = 'pan-y';
    plot.over.addEventListener('pointerdown', (event) => {
      plot.over.setPointerCapture(event.pointerId);
      go(event);
    });
    plot.over.addEventListener('pointermove', (event) => event.buttons & 1 && go(event));
  }

  drawFrame(plot) {
    if (!this.content.frames || this.hidden) return;
    const { ctx, bbox } = plot;
    const scale = devicePixelRatio || 1;
    const x = Math.round(plot.valToPos(this.frame, 'x', true));
    ctx.save();
    ctx.strokeStyle = styleValue('--accent');
    ctx.fillStyle = styleValue('--accent');
    ctx.setLineDash([]);
    ctx.lineWidth = 1.5 * scale;
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    const at = plot.data[0].indexOf(this.frame);
    this.content.series.forEach((s, i) => {
      const y = at < 0 ? null : plot.data[i + 1][at];
      if (y === null || y === undefined || s.strong === false) return;
      ctx.fillStyle = s.color;
      ctx.beginPath();
      ctx.arc(x, plot.valToPos(y, 'y', true), 3.6 * scale, 0, 2 * Math.PI);
      ctx.fill();
    });
    ctx.restore();
  }

  /** Draws the frame's line where it is; later, if the curves are out of sight. */
  moveTo(frame) {
    const moved = frame !== this.frame;
    this.frame = frame;
    if (this.inSight) this.plot?.redraw(false, false);
    else this.stale = this.stale || moved;
  }
  retheme() {
    if (this.content) this.draw(this.content);
  }
}
