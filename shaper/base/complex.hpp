// SPDX-License-Identifier: Apache-2.0
// As much of complex arithmetic as the shaper design needs. Constexpr, background.
#pragma once

#include "shaper/base/math.hpp"

namespace stillpoint {

struct Complex {
  double re;
  double im;
};

constexpr Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
constexpr Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
constexpr Complex operator*(Complex a, Complex b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
constexpr Complex operator*(double a, Complex b) { return {a * b.re, a * b.im}; }
constexpr Complex& operator+=(Complex& a, Complex b) { return a = a + b; }
constexpr Complex conjugate(Complex a) { return {a.re, -a.im}; }
constexpr double square_of(Complex a) { return a.re * a.re + a.im * a.im; }
constexpr Complex operator/(Complex a, Complex b) { return (1.0 / square_of(b)) * (a * conjugate(b)); }

namespace math {

constexpr Complex exp(Complex a) { return exp(a.re) * Complex{cos(a.im), sin(a.im)}; }

}  // namespace math

}  // namespace stillpoint
