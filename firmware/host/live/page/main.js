// SPDX-License-Identifier: Apache-2.0
// Puts the page together.
import { Actions } from "./actions.js";
import { Bench } from "./bench.js";
import { Commands } from "./commands.js";
import { Connection } from "./connection.js";
import { Curves } from "./curves.js";
import { Eye } from "./eye.js";
import { Faults } from "./faults.js";
import { Findings } from "./findings.js";
import { Hands } from "./hands.js";
import { Happenings } from "./happenings.js";
import { Model } from "./model.js";
import { Moment } from "./moment.js";
import { Status } from "./status.js";
import { Transport } from "./transport.js";
import { Tuning } from "./tuning.js";

const token = new URLSearchParams(location.search).get("token") || "";
const address = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/?token=${encodeURIComponent(token)}`;
const body = (id) => document.querySelector(`#${id} .body`);

const model = new Model();
const connection = new Connection(address);
const actions = new Actions(connection, model);
const moment = new Moment(model);
model.follow(connection);

new Status(document.getElementById("status"), document.getElementById("banners"), actions, model, moment);
new Commands(body("commands"), actions, model, token);
new Transport(document.getElementById("transport"), actions, model, moment);
new Tuning(body("tuning"), actions, model);
new Faults(body("faults"), actions, model);
new Findings(body("findings"), model);
new Happenings(body("happenings"), model, moment);
new Eye(body("eye"), model, moment);
const curves = new Curves(body("lead"), body("curves"), model, moment);

// The bench is made once, when setup and scene are known.
let bench = null;
function makeBench() {
  if (bench || !model.setup || !model.links) return;
  const host = body("bench");
  host.replaceChildren();
  let hands = null;
  bench = new Bench(host, model, moment, (event) => !!hands && hands.key(event));
  if (!bench.gl) {
    host.replaceChildren(
      Fovea.absent("This browser offers no WebGL, so the bench cannot be shown in three dimensions."),
    );
    return;
  }
  hands = new Hands(bench, actions, moment);
  bench.host.append(bench.steering);
  host.append(Fovea.el("div", { class: "bench-tools" }, hands.node), hands.hint);
}

model.listen((what) => {
  if (what === "setup") {
    document.getElementById("title").textContent = model.setup.name;
    document.getElementById("eye").hidden = !model.setup.target;
    curves.build();
  }
  if (what === "setup" || what === "scene") makeBench();
});

(function draw(now) {
  curves.draw(now || 0);
  requestAnimationFrame(draw);
})();
connection.connect();
