/* Fractions modulo the prime 2^61 - 1.  A number that is nonzero here is nonzero: unlike exact
   fractions they never grow, so a wrong set of coefficients can be rejected after any number of
   steps. */

#pragma once

#include "rational.h"

namespace Oracle {

class Modular {
 public:
  Modular(long long n = 0, long long d = 1) : Modular(Rational(n, d)) {}
  Modular(const Rational &r) :
      value(times(residue(r.numerator()), inverse(residue(r.denominator()))))
  {
  }

  Modular operator*(const Modular &o) const { return of(times(value, o.value)); }
  Modular operator+(const Modular &o) const { return of((value + o.value) % P); }
  Modular operator-(const Modular &o) const { return of((value + P - o.value) % P); }
  Modular operator-() const { return of((P - value) % P); }
  bool operator==(const Modular &o) const { return value == o.value; }
  bool operator!=(const Modular &o) const { return value != o.value; }

 private:
  static constexpr unsigned long long P = (1ULL << 61) - 1;
  unsigned long long value;

  static Modular of(unsigned long long value)
  {
    Modular m;
    m.value = value;
    return m;
  }
  static unsigned long long residue(Rational::Integer n)
  {
    const Rational::Integer p = P;
    return (unsigned long long) ((n % p + p) % p);
  }
  static unsigned long long times(unsigned long long a, unsigned long long b)
  {
    return (unsigned long long) (Rational::Integer(a) * b % P);
  }
  static unsigned long long inverse(unsigned long long a)    // a^(P - 2), by Fermat
  {
    if (a == 0) throw std::domain_error("denominator divisible by the modulus");
    unsigned long long result = 1;
    for (unsigned long long power = P - 2; power > 0; power >>= 1, a = times(a, a))
      if (power & 1) result = times(result, a);
    return result;
  }
};

}    // namespace Oracle
