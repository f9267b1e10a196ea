// The page for spectators: a screen in the hall, or a phone. Nobody touches it for a whole evening.

import { Audience } from "./audience.js";
import { ArenaView } from "../arena/arena_view.js";
import { socketAddress } from "../common/addresses.js";
import { feedEntry, FeedList } from "../battle/feed_words.js";
import { askLeaders, Leaders, serverDay } from "../results/leaders.js";
import { connectPreferences } from "../common/preferences.js";
import { Preferences } from "../common/preferences_store.js";
import { RealFloor } from "../overhead/real_floor.js";
import { ScreenSchedule } from "./screen_schedule.js";
import { HallTournament } from "./tournament.js";
import { StatusFeed } from "../battle/status_feed.js";
import { ViewChoice } from "./view_choice.js";
import * as view from "./view.js";

const TICK = 500; // ms between two looks at what is to be shown
const ANNOUNCED = new Set(["countdown", "cancelled", "start", "out", "end", "aborted", "paused", "resumed"]);

const byId = (id) => document.getElementById(id);
const setting = (name) => document.querySelector(`meta[name=${name}]`)?.content;

const feed = new FeedList(byId("feed"));
const schedule = new ScreenSchedule();
const leaders = new Leaders(() => askLeaders(serverDay(Date.now(), Number(setting("utc-offset")))));
const viewChoice = new ViewChoice();
const takeArena = (state) => {
  view.showArena(state);
  viewChoice.takeArena(state !== "none");
};
const arena = new ArenaView(byId("arena"), takeArena, (frame) => realFloor.show(frame));
const realFloor = new RealFloor({ box: byId("arena"), preferences: new Preferences(), onPicture: (picture) => (arena.realFloor = picture) });
const audience = new Audience();
const tournament = new HallTournament();
let status = null;
let shown = null; // the players of the leaderboard on the page

function take(current) {
  const news = feed.take(status, current);
  status = current;
  schedule.take(current, news, performance.now());
  if (news.some((change) => change.kind === "end")) view.showPodium(current);
  view.showStatus(current);
  audience.show();
  view.announce(news.filter((change) => ANNOUNCED.has(change.kind)).map((change) => feedEntry(change).text).join(" "));
  arena.take(current, null);
  viewChoice.take(current.users);
  tournament.take(current);
  look();
}

/** Time passes, though nothing else may. */
function look() {
  leaders.tick(status !== null && !schedule.isBusy);
  if (leaders.players !== shown) {
    shown = leaders.players;
    view.showLeaders(shown);
  }
  view.showPanel(schedule.panel(performance.now(), shown.length > 0, audience.hasVote));
}

connectPreferences();
audience.start();
new StatusFeed({
  url: socketAddress("rosbridge"),
  onStatus: take,
  onState: view.showConnection,
  topics: [...arena.topics, ...realFloor.topics],
}).start();
setInterval(look, TICK);
