// Grids of spheres with MToon in GLBs made in code: in each row, one property grows to the right. Without outlines of
// `screenCoordinates`, which three-vrm draws half as wide as specified.
import { grid } from "./spheres.mjs";

const COLUMNS = 5;

/** MToon of VRM 1.0 by row, for a share from 0 (left) to 1 (right). @type {((share: number) => object)[]} */
const ROWS = [
  (share) => ({ shadingToonyFactor: 0.95 * share }),
  (share) => ({ shadingShiftFactor: 1.2 * share - 0.6, shadingToonyFactor: 0.7 }),
  (share) => ({ giEqualizationFactor: share, shadeColorFactor: [0, 0, 0] }),
  (share) => ({
    parametricRimColorFactor: [0.2, 0.6, 0.9],
    parametricRimFresnelPowerFactor: 1 + 6 * share,
    parametricRimLiftFactor: 0.3 * share,
    rimLightingMixFactor: share,
  }),
  (share) => ({
    outlineWidthMode: "worldCoordinates",
    outlineWidthFactor: 0.03 + 0.1 * share,
    outlineColorFactor: [0.9, 0.5, 0.1],
    outlineLightingMixFactor: 1 - share,
  }),
];

/** Properties of the shader of VRM 0.x. @typedef {{ numbers?: object, colors?: object }} Properties0 */

/** The same of VRM 0.x; colours are in gamma space. @type {((share: number) => Properties0)[]} */
const ROWS_0 = [
  (share) => ({ numbers: { _ShadeToony: 0.95 * share } }),
  (share) => ({ numbers: { _ShadeShift: 1.2 * share - 0.6, _ShadeToony: 0.3 } }),
  (share) => ({ numbers: { _IndirectLightIntensity: 0.05 + 0.95 * share }, colors: { _ShadeColor: [0, 0, 0, 1] } }),
  (share) => ({
    numbers: { _RimFresnelPower: 1 + 6 * share, _RimLift: 0.3 * share, _RimLightingMix: share },
    colors: { _RimColor: [0.5, 0.8, 0.95, 1] },
  }),
  (share) => ({
    numbers: { _OutlineWidthMode: 1, _OutlineWidth: 3 + 10 * share, _OutlineColorMode: 1, _OutlineLightingMix: 1 - share },
    colors: { _OutlineColor: [0.95, 0.7, 0.3, 1] },
  }),
];

/** @template T @param {((share: number) => T)[]} rows */
const columns = (rows) => rows.map((row) => Array.from({ length: COLUMNS }, (_, column) => row(column / (COLUMNS - 1))));

/** Returns a GLB with VRMC_materials_mtoon. */
export function toonGrid() {
  const rows = columns(ROWS).map((row) =>
    row.map((toon) => ({
      pbrMetallicRoughness: { baseColorFactor: [0.8, 0.6, 0.5, 1] },
      extensions: { VRMC_materials_mtoon: { specVersion: "1.0", shadeColorFactor: [0.3, 0.1, 0.2], ...toon } },
    })),
  );
  return grid(rows, { extensionsUsed: ["VRMC_materials_mtoon"] });
}

/** Returns a GLB with MToon of VRM 0.x. */
export function toonGrid0() {
  const rows = columns(ROWS_0);
  const materialProperties = rows.flat().map(({ numbers, colors }) => ({
    shader: "VRM/MToon",
    renderQueue: 2000,
    floatProperties: numbers ?? {},
    vectorProperties: { _Color: [0.9, 0.8, 0.7, 1], _ShadeColor: [0.6, 0.3, 0.5, 1], ...colors },
    textureProperties: {},
    keywordMap: {},
    tagMap: {},
  }));
  const extensions = { VRM: { specVersion: "0.0", materialProperties } };
  return grid(rows.map((row) => row.map(() => ({}))), { extensionsUsed: ["VRM"], extensions });
}
