"""Properties of a dilute gas from collision integrals, in the first Chapman-Enskog approximation.

Formulas are from J. O. Hirschfelder, C. F. Curtiss and R. B. Bird, Molecular Theory of Gases and Liquids, Wiley
(1954), of E. A. Mason and E. W. McDaniel, Transport Properties of Ions in Gases, Wiley (1988), and of L.
Monchick, K. S. Yun and E. A. Mason, J. Chem. Phys. 39, 654 (1963), below as HCB, MM and MYM.
"""

import numpy as np

from gearquat_analysis.units import UNITS

from .integrals import Estimate, thermal_speed

#: exact constants of the SI: Boltzmann's, J/K, and the elementary charge, C
BOLTZMANN, ELEMENTARY_CHARGE = 1.380649e-23, 1.602176634e-19
#: Pa, and 1/m^3 at 273.15 K and that pressure
ATMOSPHERE = 101325.0
LOSCHMIDT = ATMOSPHERE / (BOLTZMANN * 273.15)
#: styles of units in which charges are in units of the elementary charge
CHARGED = ("real", "metal", "electron")


def viscosity(facts, temperature):
    """Function of the means: k T 5 / (8 Omega(2,2)), HCB (8.2-18), in energy x time / length^3."""
    thermal = UNITS[facts.style].boltzmann * temperature
    return lambda means: 5.0 * thermal / (8.0 * means["Omega(2,2)"])


def diffusion(facts, temperature):
    """Function of the means: n D = 3 k T / (16 mu Omega(1,1)), HCB (8.2-44), in 1/(length x time)."""
    units = UNITS[facts.style]
    thermal = units.boltzmann * temperature / (facts.reduced_mass * units.energy)
    return lambda means: 3.0 * thermal / (16.0 * means["Omega(1,1)"])


def relaxation(facts, temperature):
    """Function of the means: 1 / (n tau) of the rotation of one of two equal molecules, MYM, in length^3/time.

    1 / tau = (n / 4) (k / c) (8 k T / (pi mu))^(1/2) bar(d^2), averaged with x exp(-x), where c is the heat
    capacity of rotation of a molecule; it follows from detailed balance.
    """
    capacity = facts.freedoms[0] / 2.0
    # the mean relative speed is four times the speed of the integrals
    speed = 4.0 * thermal_speed(facts, temperature)
    return lambda means: 0.25 / capacity * speed * means["transfer"]


def collision_number(facts, temperature):
    """Function of the means: 4 p tau / (pi eta), MYM."""
    thermal = UNITS[facts.style].boltzmann * temperature
    eta, rate = viscosity(facts, temperature), relaxation(facts, temperature)
    return lambda means: 4.0 * thermal / (np.pi * eta(means) * rate(means))


def ratios():
    """Name -> (function of the means, unit, description): combinations of reduced collision integrals, HCB (8.2-15)."""
    return {
        "A*": (lambda means: means["Omega(2,2)"] / (2.0 * means["Omega(1,1)"]), "", "Omega(2,2)* / Omega(1,1)*"),
        "C*": (lambda means: means["Omega(1,2)"] / (3.0 * means["Omega(1,1)"]), "", "Omega(1,2)* / Omega(1,1)*"),
    }


def reduced(facts, temperature, sigma):
    """Collision integrals divided by the integrals of rigid spheres of diameter ``sigma``, HCB (8.2-8), as ratios."""
    sphere = thermal_speed(facts, temperature) * np.pi * sigma**2
    spheres = {"Omega(1,1)": sphere, "Omega(2,2)": 2.0 * sphere, "Omega(1,2)": 3.0 * sphere}
    about = "by the integral of rigid spheres"
    return {
        f"{name}*": (lambda means, name=name, whole=whole: means[name] / whole, "", f"{name} {about}")
        for name, whole in spheres.items()
    }


def derived(facts, temperature, sigma=None):
    """Name -> (function of the means, unit, description) of all quantities that apply to this pair; empty without a temperature."""
    if temperature is None:
        return {}
    found = ratios()
    if sigma:
        found = reduced(facts, temperature, sigma) | found
    si = facts.style != "lj"
    if facts.identical:
        scale, unit = (_pascal_second(facts.style) * 1e6, "µPa s") if si else (1.0, "energy time/length^3")
        found["viscosity"] = (_times(viscosity(facts, temperature), scale), unit, "viscosity of the dilute gas")
        if facts.freedoms[0]:
            number = collision_number(facts, temperature)
            found["collision number"] = (number, "", "collision number of rotation, 4 p tau / (pi eta)")
    scale, unit = _diffusion_unit(facts.style, temperature) if si else (1.0, "1/(length time)")
    about = "self-diffusion" if facts.identical else "diffusion of one kind in the other"
    about += ", at 1 atm" if si else ", times the number density"
    found["diffusion"] = (_times(diffusion(facts, temperature), scale), unit, about)
    ion = _charge_of_ion(facts)
    if ion:
        about = "reduced mobility in a weak field, MM (5-3-1)"
        found["mobility"] = (_mobility(facts, temperature, ion), "cm^2/(V s)", about)
    return found


def derived_estimates(averages, facts, temperature, sigma=None):
    """Name -> Estimate of all quantities that are derived from the means."""
    return {
        name: Estimate(*averages.of(function), unit, about)
        for name, (function, unit, about) in derived(facts, temperature, sigma).items()
    }


def _times(function, scale):
    return lambda means: scale * function(means)


# --- the SI -----------------------------------------------------------------------------------------
def _joule(style):
    """Unit of energy of a style, in J."""
    return BOLTZMANN / UNITS[style].boltzmann


def _meter_second(style):
    """Units of length and time of a style, in m and s."""
    return UNITS[style].angstrom * 1e-10, UNITS[style].ps * 1e-12


def _pascal_second(style):
    """Unit of viscosity of a style, in Pa s."""
    meter, second = _meter_second(style)
    return _joule(style) * second / meter**3


def _diffusion_unit(style, temperature):
    """n D in units of the deck becomes D in cm^2/s at one atmosphere: (factor, name of the unit)."""
    meter, second = _meter_second(style)
    density = ATMOSPHERE / (BOLTZMANN * temperature)
    return 1e4 / (meter * second * density), "cm^2/s"


def _charge_of_ion(facts):
    """The charge in elementary charges if exactly one body of the pair is charged, otherwise None."""
    if facts.charge is None or facts.style not in CHARGED:
        return None
    charges = [charge for charge in facts.charge if abs(charge) > 1e-3]
    return charges[0] if len(charges) == 1 else None


def _mobility(facts, temperature, charge):
    """Function of the means: (3 q / (16 N)) (2 pi / (mu k T))^(1/2) / Omega, MM (5-3-1), at 273.15 K and 1 atm."""
    meter, second = _meter_second(facts.style)
    mass = facts.reduced_mass * UNITS[facts.style].energy * _joule(facts.style) * (second / meter) ** 2
    speed = np.sqrt(2.0 * np.pi / (mass * BOLTZMANN * temperature))
    factor = 3.0 * abs(charge) * ELEMENTARY_CHARGE / (16.0 * LOSCHMIDT) * speed * 1e4 / meter**2
    return lambda means: factor / means["cross section"]
