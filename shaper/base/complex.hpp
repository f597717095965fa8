// SPDX-License-Identifier: Apache-2.0
// As much of complex arithmetic as the shaper design needs. Constexpr, background; products out of line, for each is
// six calls where doubles are soft.
#pragma once

#include "shaper/base/math.hpp"

namespace stillpoint {

struct Complex {
  double re;
  double im;
};

[[gnu::noinline]] constexpr Complex operator+(const Complex& a, const Complex& b) { return {a.re + b.re, a.im + b.im}; }
[[gnu::noinline]] constexpr Complex operator-(const Complex& a, const Complex& b) { return {a.re - b.re, a.im - b.im}; }
[[gnu::noinline]] constexpr Complex operator*(const Complex& a, const Complex& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
[[gnu::noinline]] constexpr Complex operator*(double a, const Complex& b) { return {a * b.re, a * b.im}; }
constexpr Complex& operator+=(Complex& a, const Complex& b) { return a = a + b; }
[[gnu::noinline]] constexpr Complex conjugate(const Complex& a) { return {a.re, -a.im}; }
[[gnu::noinline]] constexpr double square_of(const Complex& a) { return a.re * a.re + a.im * a.im; }
[[gnu::noinline]] constexpr Complex operator/(const Complex& a, const Complex& b) {
  return (1.0 / square_of(b)) * (a * conjugate(b));
}

namespace math {

[[gnu::noinline]] constexpr Complex exp(const Complex& a) { return exp(a.re) * Complex{cos(a.im), sin(a.im)}; }

}  // namespace math

}  // namespace stillpoint
