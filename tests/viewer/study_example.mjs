// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A study as `morula study` writes it, with numbers made up for the tests of the page.
const frames = Array.from({ length: 13 }, (_, frame) => frame);
const arch = (low, high) => frames.map((frame) => low + (high - low) * Math.sin((Math.PI * frame) / 12));

/** Looks as the command writes them. */
const look = (light, dark, dash, marker, more = {}) => ({ light, dark, dash, marker, strong: true, hollow: false, dots: false, ...more });
const approach1 = look('#911a01', '#e86f0a', [8, 3, 2, 3], 'triangle');
const approach2 = look('#293d89', '#1e6bcb', [9, 4], 'diamond');
const exact = look('#2e7956', '#7effb4', [], 'circle');
const fresh = look('#3c3149', '#cff4ff', [], 'pentagon', { hollow: true, dots: true });
const uncovered = frames.map((frame) => frame > 2 && frame < 10);
/** One of the paper's figures. */
const fig2 = (part, id) => ({
  id, title: `Fig. 2 ${part}. Looseness: generators, level 2, bend 90`, x: { label: 'sample', unit: '' }, y: { label: 'looseness', unit: 'volumes' }, frame_axis: true, motion: 'bend', body: 'limb',
  series: [{ name: 'medial', x: frames, y: arch(0.02, 0.2), role: 'method', style: approach2, uncovered }, { name: 'medial, exact', x: frames, y: arch(0.02, 0.3), role: 'reference', style: { ...approach2, dash: [] } }],
});

export const study = {
  morula: '0.0.0',
  title: 'Evaluation',
  settings: { branching: 8, depth: 3, frames: 13, note: 'made-up numbers </script><b>not markup</b>' },
  bodies: [{ name: 'limb', vertices: 1282, facets: 2560, volume: 3.2 }],
  summary: ['The paper makes 3 claims.', 'On limb 1 holds, 1 holds partly and 1 fails.', 'Looseness alone rewards rules that leave surface uncovered: Approach 2 is the tightest of them.'],
  claims: [
    { id: 'approach2-below-approach1', source: 'paper', claim: 'Approach 2 stays tighter than approach 1 while the body bends.', verdict: 'holds', numbers: 'Worst frame: 0.224 against 0.537 object volumes.', figures: ['fig2a', 'fig2b'], place: 'results, Fig. 2 a', counts: { trials: 2, holds: 1, partly: 1, fails: 0 }, trials: [{ body: 'limb', seed: 1, verdict: 'holds', cases: 6, true: 6, value: 0.4 }, { body: 'bar', seed: 1, verdict: 'partly', cases: 6, true: 3, value: 0.9 }] },
    { id: 'covers', source: 'paper', claim: 'Spheres keep containing the surface under every update.', verdict: 'fails', numbers: 'Approach 2 leaves 13.4 % of the surface uncovered in the worst frame.', figures: ['fig3'] },
    { id: 'cost', source: 'paper', claim: 'The cost of an update grows with the number of links.', verdict: 'partly', numbers: 'It does for leaves; inner nodes cost the same.', figures: ['fig4', 'nowhere'] },
    { id: 'exact', source: 'new', claim: 'The rule exact leaves no surface uncovered, and tighter than the other rules under bending.', verdict: 'holds', numbers: '0.0824 object volumes, 0 uncovered.', figures: ['fig2a', 'fig3'] },
    { id: 'uncovered', source: 'new', claim: 'Approach 1 leaves surface uncovered.', verdict: 'fails', adverse: true, numbers: 'In 0 of 24 cases.', figures: [] },
    { id: 'later', source: 'new', claim: 'Contacts are found in time.', verdict: 'not decided', numbers: '', figures: [] },
  ],
  figures: [
    { id: 'fig2a', title: 'Fig. 2 a. Looseness: rules, grid, level 2, bend 90', note: 'Leaves, grid tree.', x: { label: 'frame', unit: '' }, y: { label: 'looseness', unit: 'volumes' }, frame_axis: true, motion: 'bend', body: 'limb',
      series: [
        { name: 'approach 1', x: frames, y: arch(0.02, 0.54), role: 'method', style: approach1 },
        { name: 'approach 2', x: frames, y: arch(0.02, 0.22), role: 'method', style: approach2, uncovered },
        { name: 'exact', x: frames, y: arch(0.02, 0.08), role: 'method', style: exact },
        { name: 'built anew', x: frames, y: arch(0.02, 0.05), role: 'reference', style: fresh },
      ] },
    fig2('b', 'fig2b'),
    fig2('c', 'fig2c-bend'),
    fig2('d', 'fig2d-bend'),
    { id: 'fig3', title: 'Uncovered area while bending', x: { label: 'frame', unit: '' }, y: { label: 'uncovered', unit: '%' }, frame_axis: true, motion: 'bend', body: 'limb',
      series: [
        { name: 'approach 2', x: frames, y: arch(0, 13.4), role: 'uncovered', style: approach2 },
        { name: 'exact', x: frames, y: frames.map((frame) => (frame === 4 ? null : 0)), role: 'method', style: exact },
      ] },
    { id: 'fig4', title: 'Time of an update', x: { label: 'vertices', unit: '' }, y: { label: 'time', unit: 'µs', log: true }, frame_axis: false,
      series: [
        { name: 'exact', x: [1000, 10000, 40000, 176000], y: [9, 80, 290, 940], role: 'method', style: exact },
        { name: 'approach 2', x: [1000, 10000, 40000, 176000], y: [5, 40, 160, 640], role: 'method', style: approach2 },
      ] },
  ],
  tables: [{ id: 'worst', title: 'Worst frames', note: 'Looseness in object volumes.', columns: ['rule', 'looseness', 'uncovered', 'frame'], rows: [['traditional', 0.43, 0.004, 6], ['approach 2', 0.224, 0.134, 6], ['exact', 0.0824, 0, null]] }],
  pictures: [{ id: 'fig1', title: 'Fig. 1. limb', svg: '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1080 610" width="1080" height="610"><rect width="100%" height="100%" fill="#888"/></svg>' }, { id: 'levels', title: 'Levels', svg: '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 80"><script>document.title = "no"</script><g fill="none" stroke="currentColor"><circle cx="50" cy="40" r="34"/><circle cx="120" cy="40" r="20" onclick="alert(1)"/><circle cx="165" cy="40" r="12"/></g></svg>' }],
};
