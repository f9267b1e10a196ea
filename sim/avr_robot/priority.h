#pragma once

/* Takes the real-time priority that LASERBOT_PRIORITY says (1 unless it is set, 0: none) for this thread and those that
 * it starts, where the system grants it. A simulator that cannot keep up has its usual priority again: it would leave
 * the others nothing of a processor. */
void priority_take(void);
