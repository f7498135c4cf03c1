// The times of a series: a slider, steps, and play, which waits for each picture.

import { useEffect, useRef, useState } from "preact/hooks";
import { set } from "../../state/patch.ts";
import type { PartProps } from "../part.ts";
import { Button, Switch, NumberBox } from "../fields.tsx";
import { nextTime, shownViews, waitFor } from "./time_steps.ts";
import { WORDS } from "../../words.ts";

const TEXT = WORDS.timeBar;
const MAX_RATE = 60;
const GESTURE = "time";

export function TimeBar({ store, ui, welcome }: PartProps) {
  const count = Math.max(1, ...welcome.volumes.map((volume) => volume.n_times));
  const series = welcome.volumes.flatMap((volume, index) => (volume.n_times > 1 ? [index] : []));
  const timeNow = (): number => Math.max(0, ...series.map((index) => store.state.layers[index]?.time ?? 0));
  const time = timeNow();
  const [isPlaying, setPlaying] = useState(false);
  const [rate, setRate] = useState(10);
  const [repeats, setRepeats] = useState(true);
  const text = TEXT.of(time, count, welcome.volumes.find(({ times }) => (times?.length ?? 0) === count)?.times?.[time]);
  const last = useRef<{ at: number; seq: number }>({ at: 0, seq: 0 });

  const go = (next: number): void => {
    const operations = series.map((index) =>
      set(Math.min(next, (welcome.volumes[index]?.n_times ?? 1) - 1), "layers", index, "time"),
    );
    store.change(operations, GESTURE);
    last.current = { at: performance.now(), seq: store.seq };
  };
  const step = (by: number): void => {
    go((timeNow() + by + count) % count);
    store.settle();
  };
  const stop = (): void => {
    setPlaying(false);
    store.settle();
  };
  const toggle = (): void => {
    if (isPlaying) stop();
    else {
      if (time === count - 1 && !repeats) go(0);
      setPlaying(true);
    }
  };

  // The slowest of the views that are shown leads. One without a frame yet is not waited for.
  const isShown = shownViews(store.state.view.layout).every(
    (view) => (ui.frames[view]?.seq ?? Infinity) >= last.current.seq,
  );
  useEffect(() => {
    if (!isPlaying) return undefined;
    const wait = waitFor(performance.now(), { at: last.current.at, isShown }, rate);
    if (wait === null) return undefined;
    const timer = setTimeout(() => {
      const next = nextTime(time, count, repeats);
      if (next === null) stop();
      else go(next);
    }, wait);
    return () => clearTimeout(timer);
  }, [isPlaying, isShown, time, rate, repeats]);

  if (count < 2) return null;
  return (
    <div class="look-time" role="group" aria-label={TEXT.title}>
      <Button label={TEXT.before} onClick={() => step(-1)}>
        ‹
      </Button>
      <button type="button" class="button look-play" title={TEXT.playKey} aria-pressed={isPlaying} onClick={toggle}>
        {isPlaying ? TEXT.pause : TEXT.play}
      </button>
      <Button label={TEXT.next} onClick={() => step(1)}>
        ›
      </Button>
      <input
        type="range"
        aria-label={TEXT.title}
        aria-valuetext={text}
        min={0}
        max={count - 1}
        step={1}
        value={time}
        onInput={(event) => {
          setPlaying(false);
          go(event.currentTarget.valueAsNumber);
        }}
        onChange={() => store.settle()}
      />
      <output class="look-count">{text}</output>
      <label class="row">
        <NumberBox
          label={TEXT.rate}
          min={0.2}
          max={MAX_RATE}
          step={1}
          value={rate}
          onInput={setRate}
          onSettle={() => {}}
        />
        <span class="dim" aria-hidden="true">
          {TEXT.perSecond}
        </span>
      </label>
      <Switch label={TEXT.repeat} on={repeats} onToggle={setRepeats} />
    </div>
  );
}
