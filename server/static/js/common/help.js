// How to play, as a dialog.

import * as dialogs from "./dialogs.js";
import { element } from "./dom.js";
import { t } from "./words.js";

export function help() {
  const caps = (keys) => keys.map((key) => element("kbd", {}, key));
  const row = (keys, meaning) =>
    element("div", { className: "help-row" }, element("span", { className: "help-keys" }, ...caps(keys)), meaning);
  return dialogs.show({
    title: t("help.title"),
    body: [
      row(["↑", "←", "↓", "→"], t("help.move")),
      row(["W", "A", "S", "D"], t("help.move")),
      row(["Enter", "Space"], t("help.fire")),
      row(["V"], t("help.view")),
      ...["touch", "rules", "charge"].map((key) => element("p", {}, t(`help.${key}`))),
    ],
  });
}
