// How old a camera's picture is, and what that means for whoever drives by it. Pure.

import { number, t } from "../common/words.js";

const NOTICEABLE = 0.3; // s
export const STALE = 1; // s; whoever drives by such a picture drives blind

/**
 * @param {number} age of the picture on the screen, in s
 * @returns {{level: "fresh"|"late"|"stale", text: string}} text to be shown with it; empty while nobody would notice
 */
export function ageOf(age) {
  if (age < NOTICEABLE) return { level: "fresh", text: "" };
  const level = age < STALE ? "late" : "stale";
  const digits = level === "late" ? 1 : 0;
  return { level, text: t("camera.age", { s: number(age, { minimumFractionDigits: digits, maximumFractionDigits: digits }) }) };
}
