import { avatarUrl } from "./assets.js";
import { element } from "./dom.js";
export const podiumView = (result) => element("ol", {}, ...result.map((e) => element("li", {}, element("img", { src: avatarUrl(e.avatar), width: 40, height: 40, alt: "" }), `${e.place} ${e.name} ${e.life}`)));
