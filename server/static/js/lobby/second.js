// A worker that ticks once a second: browsers let the timers of a page that was hidden for minutes wait for a minute, which
// is longer than a robot is offered, and than the server waits for a sign of life.

setInterval(() => postMessage("a second"), 1000);
