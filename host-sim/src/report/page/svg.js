'use strict';

// Drawing: elements, and scales.

const NAMESPACE = document.querySelector('svg').namespaceURI;

/** Adds an element to a parent, with attributes and text. */
function add(parent, name, attributes = {}, text = '') {
  const isSvg = parent.namespaceURI === NAMESPACE || name === 'svg';
  const element = isSvg ? document.createElementNS(NAMESPACE, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== '') element.textContent = text;
  parent.append(element);
  return element;
}

/** Empties a drawing and gives it a size; its units are pixels. */
function blank(svg, width, height) {
  svg.replaceChildren();
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  svg.setAttribute('height', height);
  return svg;
}

/** A path through pixels. */
function through(pixels, isClosed = false) {
  if (pixels.length === 0) return '';
  return `M${pixels.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join('L')}${isClosed ? 'Z' : ''}`;
}

/** A linear scale. */
function linear([from, to], [first, last]) {
  const span = to - from || 1;
  return (value) => first + ((value - from) / span) * (last - first);
}

/** Round values from `from` to `to`, some `count` of them. */
function ticks(from, to, count) {
  const rough = (to - from) / count || 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((it) => it * power).find((it) => it >= rough * 0.999);
  const values = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; k += 1) {
    values.push(Number((k * step).toPrecision(12)));
  }
  return values;
}

/** Numbers as they are read: a true minus, and no more digits than say something. */
function figure(value, decimals) {
  return value.toFixed(decimals).replace('-', '\u2212');
}

/** A size that may be very small. */
function small(value) {
  if (value === 0) return '0';
  const text = value >= 1e-4 ? String(Number(value.toPrecision(3))) : value.toExponential(1);
  return text.replace('-', '\u2212');
}
