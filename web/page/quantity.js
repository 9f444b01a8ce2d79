// Figures on the page: units by magnitude, three digits, typed text, and where a value lies on a slider.

const PRESSURES = [
  [1e9, "GPa"],
  [1e6, "MPa"],
  [1e3, "kPa"],
  [1, "Pa"],
];
const WRITTEN = { x: "×", "m/s2": "m/s²", "J/m2": "J/m²", "kg/m3": "kg/m³", "J/m3": "J/m³" };
const PREFIXES = { G: 1e9, M: 1e6, k: 1e3 };
export const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

/// {factor, text}: how a parameter's SI unit is shown; pressures take the prefix of their default.
export function shown_unit({ unit = "", default: standard, max }) {
  if (unit !== "Pa") return { factor: 1, text: WRITTEN[unit] ?? unit };
  const size = Math.abs(Number(standard)) || Math.abs(max) || 1;
  const [factor, text] = PRESSURES.find(([least]) => size >= least) ?? [1, "Pa"];
  return { factor, text };
}

// Below it nothing on the page means anything but zero.
const NOTHING = 1e-9;

/// Up to `digits` significant digits and never an exponent.
export function format_number(value, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  if (Math.abs(value) < NOTHING) return "0";
  const rounded = Number(value.toPrecision(digits)),
    plain = String(rounded);
  if (!plain.includes("e")) return plain;
  const decimals = clamp(digits - 1 - Math.floor(Math.log10(Math.abs(rounded))), 0, 20);
  return rounded.toFixed(decimals);
}

/// With thousands set apart, for counts.
export const format_count = (value) => Math.round(value).toLocaleString("en");

/// Typed text to SI, NaN when it is no number: "20" and "2,5" are in the shown unit, "20k" in the base unit.
export function parse_typed(text, { factor, text: unit }) {
  const match = text
    .trim()
    .replace(",", ".")
    .match(/^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([GMk]?)(.*)$/);
  if (!match) return NaN;
  const [, digits, prefix, rest] = match;
  const base = unit.replace(/^[GMk](?=Pa$)/, "");
  if (rest && rest !== base && rest !== unit) return NaN;
  if (prefix) return Number(digits) * PREFIXES[prefix];
  return Number(digits) * (rest && rest === base && base !== unit ? 1 : factor);
}

/// Position 0..1 of a value on its slider.
export function position_of(parameter, value) {
  const { min, max, scale } = parameter;
  if (max <= min) return 0;
  const share =
    scale === "log" && min > 0
      ? Math.log(value / min) / Math.log(max / min)
      : (value - min) / (max - min);
  return clamp(share, 0, 1);
}

/// The value at a position, rounded to the parameter's step or to three digits.
export function value_at(parameter, position) {
  const { min, max, scale, step } = parameter;
  const t = clamp(position, 0, 1);
  if (t === 0) return min;
  if (t === 1) return max;
  const value = scale === "log" && min > 0 ? min * (max / min) ** t : min + (max - min) * t;
  if (step)
    return clamp(Number((min + Math.round((value - min) / step) * step).toPrecision(12)), min, max);
  return clamp(Number(value.toPrecision(3)), min, max);
}

/// Round values to write under a slider, at most `most` of them.
export function round_ticks({ min, max, scale }, factor, most = 7) {
  const low = min / factor,
    high = max / factor,
    all = [];
  if (scale === "log" && low > 0) {
    for (const digits of [[1, 2, 5], [1, 3], [1]]) {
      all.length = 0;
      for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high) + 1e-9; e++) {
        for (const digit of digits) {
          const tick = Number((digit * 10 ** e).toPrecision(1));
          if (tick >= low * 0.999 && tick <= high * 1.001) all.push(tick);
        }
      }
      if (all.length <= most) return all;
    }
    return all.filter((_, i) => i % Math.ceil(all.length / most) === 0);
  }
  const rough = (high - low) / (most - 2),
    power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((candidate) => candidate >= rough);
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-9); k++)
    all.push(Number((k * step).toPrecision(6)));
  return all;
}
