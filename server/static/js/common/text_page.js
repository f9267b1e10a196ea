// Pages of text: only language, colours and moments.

import { showMoments } from "./local_times.js";
import { connectPreferences } from "./preferences.js";

connectPreferences();
showMoments();
