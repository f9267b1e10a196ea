// Who wants to play: the picture and the name in the form of a page (templates/who.html).

import { avatarUrl } from "./assets.js";
import { setText } from "./dom.js";
import { isValidName, tidyName } from "./player_name.js";
import { AVATARS } from "./storage.js";
import { t } from "./words.js";

export class Who {
  #field = document.getElementById("username");
  #rule = document.getElementById("name-rule");
  #picture = document.getElementById("userImage");
  #avatar;

  /** @param {{name: string, avatar: number}|null} guest whom the arenas know already */
  constructor(guest) {
    this.#avatar = guest ? guest.avatar % AVATARS : Math.floor(Math.random() * AVATARS);
    if (guest) this.name = guest.name;
    this.#show();
    document.getElementById("avatar").addEventListener("click", () => {
      this.#avatar = (this.#avatar + 1) % AVATARS;
      this.#show();
    });
    this.#field.addEventListener("input", () => this.#mark(this.#field.value.trim() === "" || this.#isGood())); // an empty field is a beginning
  }

  get name() {
    return tidyName(this.#field.value);
  }

  set name(name) {
    this.#field.value = name;
  }

  get avatar() {
    return this.#avatar;
  }

  focus() {
    this.#field.focus();
  }

  /** Whether the name can be one. If not, the rule beside the field tells, and the cursor is there. */
  check() {
    const isGood = this.#isGood();
    this.#mark(isGood);
    if (!isGood) this.focus();
    return isGood;
  }

  #isGood() {
    return isValidName(this.name);
  }

  #mark(isGood) {
    this.#field.setAttribute("aria-invalid", String(!isGood));
    setText(this.#rule, t(isGood ? "login.rule" : "login.bad_name"));
  }

  #show() {
    this.#picture.src = avatarUrl(this.#avatar);
    this.#picture.alt = t("login.picture", { n: this.#avatar + 1, all: AVATARS });
  }
}
