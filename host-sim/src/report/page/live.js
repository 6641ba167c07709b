// A mission that is still flown: its scenes arrive as they are made, and the last is shown unless whoever looks has gone
// to another.

const badge = document.getElementById('live');
const [shownLive] = chapters;
const [flown] = shownLive.flights;
const rows = shownLive.section.querySelector('table.told tbody');
const arrived = { scenes: [], end: null, isDue: false };
const said = { state: 'lost', notice: '' };
flown.isGrowing = true;
flown.shown = undefined;

/** Whether the last step is to be shown whichever it is. */
function isFollowing() {
  return state.timer === null && state.step === shownLive.steps;
}

/** Says whether the page is live, or why the mission has ended, and what the vehicle or the board says. */
function tellState() {
  const ended = flown.ended[0]?.text;
  const texts = {
    live: isFollowing() ? 'Live' : 'Live: go to the last step to follow it',
    lost: 'Not connected, trying again',
    ended: `Ended. ${ended}`,
  };
  const words = `${texts[said.state]}\n${said.notice}`;
  if (badge.dataset.words === words) return;
  Object.assign(badge.dataset, { words, state: said.state });
  badge.textContent = texts[said.state];
  if (said.notice !== '') add(badge, 'span', {}, ` ${said.notice}`);
}

/** Takes in what has arrived, all at once: much may have, and pages that nobody sees draw nothing. */
function takeIn() {
  const { scenes, end } = arrived;
  Object.assign(arrived, { scenes: [], end: null, isDue: false });
  const follows = isFollowing();
  for (const [scene, row] of scenes) {
    addScene(flown, JSON.parse(scene));
    rows.insertAdjacentHTML('beforeend', `${row}\n`);
  }
  if (end !== null) {
    Object.assign(flown, { ended: end.ended, rest: end.rest, isGrowing: false, shown: undefined });
    said.state = 'ended';
  }
  shownLive.renew();
  // Nobody wants every step read out.
  shownLive.quiet(follows && end === null);
  if (follows) go(shownLive.steps);
  else shownLive.fit();
  showCount();
  tellState();
}

function isDue() {
  if (!arrived.isDue) requestAnimationFrame(takeIn);
  arrived.isDue = true;
}

/** Takes an event, unless it has been taken. One of another mission means that this page is old. */
function take(event, act) {
  const [token, number] = event.lastEventId.split('.');
  if (token !== PAGE.live) location.reload();
  else if (Number(number) === flown.scenes.length + arrived.scenes.length) act();
}

function connect() {
  const source = new EventSource('scenes');
  const turn = (to) => {
    said.state = to;
    tellState();
  };
  source.addEventListener('open', () => turn('live'));
  source.addEventListener('error', () => {
    turn('lost');
    // A server that refuses is not asked again by the browser itself.
    if (source.readyState === EventSource.CLOSED) setTimeout(connect, 2000);
  });
  source.addEventListener('notice', ({ data }) => {
    said.notice = data;
    tellState();
  });
  source.addEventListener('scene', (event) => take(event, () => {
    arrived.scenes.push(event.data.split('\n'));
    isDue();
  }));
  source.addEventListener('end', (event) => take(event, () => {
    source.close();
    arrived.end = JSON.parse(event.data);
    isDue();
  }));
}

for (const kind of ['click', 'keyup', 'input']) addEventListener(kind, tellState);
tellState();
open(0);
connect();
