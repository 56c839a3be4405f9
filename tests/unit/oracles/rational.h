/* Exact fractions of 128-bit integers.  An overflow throws: a result is either exact or missing. */

#pragma once

#include <cmath>
#include <ostream>
#include <stdexcept>

namespace Oracle {

class Rational {
 public:
  __extension__ typedef __int128 Integer;

  Rational(Integer n = 0, Integer d = 1)
  {
    if (d == 0) throw std::domain_error("denominator of zero");
    const Integer g = common(n, d), sign = d < 0 ? -1 : 1;
    num = sign * n / g;
    den = sign * d / g;
  }

  // cancels common factors first, so that an overflow occurs only if the result is too large

  Rational operator*(const Rational &o) const
  {
    const Integer g = common(num, o.den), k = common(o.num, den);
    return {times(num / g, o.num / k), times(den / k, o.den / g)};
  }
  Rational operator/(const Rational &o) const { return *this * Rational(o.den, o.num); }
  Rational operator-() const { return {-num, den}; }
  Rational operator+(const Rational &o) const
  {
    const Integer g = common(den, o.den);
    Integer sum;
    if (__builtin_add_overflow(times(num, o.den / g), times(o.num, den / g), &sum))
      throw std::overflow_error("fraction too long");
    return {sum, times(den, o.den / g)};
  }
  Rational operator-(const Rational &o) const { return *this + (-o); }
  bool operator==(const Rational &o) const { return num == o.num && den == o.den; }
  bool operator!=(const Rational &o) const { return !(*this == o); }
  Integer numerator() const { return num; }
  Integer denominator() const { return den; }
  double value() const { return double(num) / double(den); }
  friend std::ostream &operator<<(std::ostream &out, const Rational &r)
  {
    return out << (long long) r.num << '/' << (long long) r.den;
  }

 private:
  Integer num, den;

  static Integer common(Integer a, Integer b)
  {
    while (b != 0) {
      const Integer rest = a % b;
      a = b;
      b = rest;
    }
    return a < 0 ? -a : (a == 0 ? 1 : a);
  }

  static Integer times(Integer a, Integer b)
  {
    Integer product;
    if (__builtin_mul_overflow(a, b, &product)) throw std::overflow_error("fraction too long");
    return product;
  }
};

/// The fraction represented by a number with an error of a few units of its last digit.
inline Rational rational_of(long double x)
{
  Rational::Integer h[2] = {1, 0}, k[2] = {0, 1};    // convergents of the continued fraction
  for (long double rest = x;;) {
    const auto whole = (Rational::Integer) std::floor(rest);
    const Rational::Integer next_h = whole * h[0] + h[1], next_k = whole * k[0] + k[1];
    h[1] = h[0], k[1] = k[0], h[0] = next_h, k[0] = next_k;
    if (std::fabs((long double) h[0] / (long double) k[0] - x) <= 1e-18L * std::fabs(x))
      return {h[0], k[0]};
    rest = 1.0L / (rest - (long double) whole);
  }
}

}    // namespace Oracle
