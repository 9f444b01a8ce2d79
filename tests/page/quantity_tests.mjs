// Units, typed text and slider scales, without a browser.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  format_number,
  parse_typed,
  position_of,
  round_ticks,
  shown_unit,
  value_at,
} from "../../web/page/quantity.js";

const threshold = { unit: "Pa", min: 2e3, max: 2e5, default: 2e4, scale: "log" };

test("pressures take the prefix of their default", () => {
  assert.deepEqual(shown_unit(threshold), { factor: 1e3, text: "kPa" });
  assert.deepEqual(shown_unit({ ...threshold, default: 2.1e11 }), { factor: 1e9, text: "GPa" });
  assert.deepEqual(shown_unit({ unit: "m/s2", default: -9.81, max: 30 }), {
    factor: 1,
    text: "m/s²",
  });
});

test("figures have three digits and no exponent", () => {
  assert.deepEqual(
    [20, 19.9996, 0.00012345, 123456, 0, 1e-9, -3e-21, NaN].map((x) => format_number(x)),
    ["20", "20", "0.000123", "123000", "0", "0.00000000100", "0", "–"],
  );
});

test("typed text", () => {
  const unit = shown_unit(threshold);
  const read = (text) => parse_typed(text, unit);
  assert.deepEqual(
    ["20", "2,5", " 20 kPa", "20k", "0.2M", "20000 Pa", "2e1", "-3"].map(read),
    [20000, 2500, 20000, 20000, 200000, 20000, 20000, -3000],
  );
  for (const bad of ["", "abc", "1.2.3", "5 m", "--2"]) assert.ok(Number.isNaN(read(bad)), bad);
});

test("a position on the slider and its value agree", () => {
  const linear = { min: -30, max: 30, scale: "linear" },
    whole = { min: 0, max: 20, step: 1, scale: "linear" };
  for (const parameter of [threshold, linear]) {
    assert.equal(value_at(parameter, 0), parameter.min);
    assert.equal(value_at(parameter, 1), parameter.max);
    for (let t = 0.05; t < 1; t += 0.05) {
      assert.ok(Math.abs(position_of(parameter, value_at(parameter, t)) - t) < 2e-3);
    }
  }
  assert.equal(position_of(threshold, 2e4), 0.5);
  assert.equal(value_at(whole, 0.26), 5);
});

test("ticks are round and few", () => {
  assert.deepEqual(round_ticks(threshold, 1e3), [2, 5, 10, 20, 50, 100, 200]);
  assert.deepEqual(round_ticks({ min: 200, max: 2e6, scale: "log" }, 1e3), [1, 10, 100, 1000]);
  assert.deepEqual(
    round_ticks({ min: 0, max: 4e5, scale: "linear" }, 1e3),
    [0, 100, 200, 300, 400],
  );
});
