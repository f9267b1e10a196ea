// Pages of text: only language, colours and moments.

import { showMoments } from "./moments.js";
import { connectPreferences } from "./preferences.js";

connectPreferences();
showMoments();
