// What presets of rules are called.

import { t } from "./words.js";

/** @param {{name: string, own: boolean}} preset an operator's own has the name that it was given */
export const presetName = ({ name, own }) => (own ? name : t(`presets.${name}`));
