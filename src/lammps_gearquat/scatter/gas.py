"""Properties of a dilute gas from means over flights, in the first Chapman-Enskog approximation.

Formulas are from J. O. Hirschfelder, C. F. Curtiss and R. B. Bird, Molecular Theory of Gases and Liquids, Wiley
(1954), of E. A. Mason and E. W. McDaniel, Transport Properties of Ions in Gases, Wiley (1988), and of L.
Monchick, K. S. Yun and E. A. Mason, J. Chem. Phys. 39, 654 (1963), below as HCB, MM and MYM.  A mean m["ls"] is the
integral of x exp(-x) bar(F_ls) dx, see integrals.py.
"""

import numpy as np

from gearquat_analysis.units import UNITS

#: exact constants of the SI: Boltzmann's, J/K, and the elementary charge, C
BOLTZMANN, ELEMENTARY_CHARGE = 1.380649e-23, 1.602176634e-19
#: Pa, and 1/m^3 at 273.15 K and that pressure
ATMOSPHERE = 101325.0
LOSCHMIDT = ATMOSPHERE / (BOLTZMANN * 273.15)
#: styles of units in which charges are in units of the elementary charge
CHARGED = ("real", "metal", "electron")


def at_one_energy():
    """Name -> (function of the means, unit, description) of flights of one energy."""
    return {
        "Q(1)": (lambda m: m["11"], "length^2", "momentum-transfer cross section"),
        "Q(2)": (lambda m: m["22"], "length^2", "viscosity cross section"),
    }


def at_temperature(facts, temperature):
    """Name -> (function of the means, unit, description) of all quantities that apply to this pair."""
    units = UNITS[facts.style]
    thermal, mass = units.boltzmann * temperature, facts.reduced_mass * units.energy
    speed = np.sqrt(thermal / (2.0 * np.pi * mass))
    omega = {name: (lambda m, name=name: 0.5 * speed * m[name]) for name in ("11", "22", "12")}
    volume = "length^3/time"
    found = {
        "Omega(1,1)": (omega["11"], volume, "collision integral of diffusion"),
        "Omega(2,2)": (omega["22"], volume, "collision integral of viscosity"),
        "Omega(1,2)": (omega["12"], volume, "collision integral of thermal diffusion"),
        "cross section": (lambda m: 0.5 * m["11"], "length^2", "averaged over energies and orientations"),
        "A*": (lambda m: m["22"] / (2.0 * m["11"]), "", "Omega(2,2)* / Omega(1,1)*, HCB (8.2-15)"),
        "C*": (lambda m: m["12"] / (3.0 * m["11"]), "", "Omega(1,2)* / Omega(1,1)*"),
    }
    # SI units of energy, length and time of the style
    reduced = facts.style == "lj"
    joule, meter, second = (BOLTZMANN / units.boltzmann, units.angstrom * 1e-10, units.ps * 1e-12)

    def viscosity(m):
        """HCB (8.2-18)."""
        return 5.0 * thermal / (8.0 * omega["22"](m))

    def diffusion(m):
        """n D, HCB (8.2-44)."""
        return 3.0 * thermal / (16.0 * mass * omega["11"](m))

    def collision_number(m):
        """4 p tau / (pi eta), MYM, for which 1 / (n tau) = (1/4) (k / c) (8 k T / (pi mu))^(1/2) bar(d^2)."""
        rate = 0.25 / (facts.freedoms[0] / 2.0) * 4.0 * speed * m["transfer"]
        return 4.0 * thermal / (np.pi * viscosity(m) * rate)

    if facts.identical:
        scale, unit = (1.0, "energy time/length^3") if reduced else (joule * second / meter**3 * 1e6, "µPa s")
        found["viscosity"] = (lambda m: scale * viscosity(m), unit, "viscosity of the dilute gas")
        if facts.freedoms[0]:
            found["collision number"] = (collision_number, "", "collision number of rotation, 4 p tau / (pi eta)")
    density = ATMOSPHERE / (BOLTZMANN * temperature)
    factor, unit = (1.0, "1/(length time)") if reduced else (1e4 / (meter * second * density), "cm^2/s")
    about = "self-diffusion" if facts.identical else "diffusion of one kind in the other"
    about += ", times the number density" if reduced else ", at 1 atm"
    found["diffusion"] = (lambda m: factor * diffusion(m), unit, about)
    charges = [charge for charge in facts.charge or () if abs(charge) > 1e-3]
    if len(charges) == 1 and facts.style in CHARGED:
        kilogram = mass * joule * (second / meter) ** 2
        root = np.sqrt(2.0 * np.pi / (kilogram * BOLTZMANN * temperature))
        mobility = 3.0 * abs(charges[0]) * ELEMENTARY_CHARGE / (16.0 * LOSCHMIDT) * root * 1e4 / meter**2
        about = "reduced mobility in a weak field, MM (5-3-1), at 273.15 K and 1 atm"
        found["mobility"] = (lambda m: mobility / (0.5 * m["11"]), "cm^2/(V s)", about)
    return found
