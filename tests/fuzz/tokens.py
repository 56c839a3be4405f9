"""Invalid words, and faults in a list of words."""

NUMBERS = (
    "0 -0 1 -1 2 3 4 5 6 7 8 9 12 13 100 101 1000 +6 -6 06 6. 6.0 .5 5. 1e1 1E-3 1e+2 1e 1e999 -1e999 1e-999 1e308 "
    "-1e308 1e-308 4.9e-324 1e20 2147483647 2147483648 -2147483648 -2147483649 4294967296 "
    "9223372036854775807 9223372036854775808 99999999999999999999999999 nan NaN -nan inf -inf infinity "
    "NULL 0x10 0b1 1d3 1,5 1_000 1/2 1e5.5 --1 +-1 1- ٣ ８ ½ −1"
).split()
TEXTS = (
    "yes no on off all none auto single molecule group custom infile mol first second x i_ v_ i_which "
    "v_half * ** @ % ~ ! ? \\ / // ../.. . .. - -- + = == ( ) [ ] { } < > | ; , : %s %n %d {} {0} "
    "naïve ☃ \u00a0x \u200b e\u0301 \U0001f40d"
).split() + ["", " ", "\t", "a" * 300, "9" * 400, "0" * 5000 + "6", "-" * 1000, "é" * 500]


def breaker(rng):
    """A word that does not belong."""
    return rng.choice(NUMBERS if rng.random() < 0.6 else TEXTS)


def cut(rng, word):
    """A word with one character lost, doubled, or changed in case or place."""
    if not word:
        return word
    at = rng.randrange(len(word))
    return rng.choice(
        (
            word[:at] + word[at + 1 :],
            word[:at] + word[at] + word[at:],
            word[:at] + word[at].swapcase() + word[at + 1 :],
            word[:at] + rng.choice("0123456789abcdefxyz_.-+") + word[at + 1 :],
            word[at:] + word[:at],
        )
    )


def mutated(rng, words, pool):
    """A copy of ``words`` with one fault; ``pool`` contains words that are valid at some position."""
    words = list(words)
    at = rng.randrange(len(words) + 1)
    kind = rng.randrange(7)
    if kind == 0 or not words:
        words.insert(at, breaker(rng) if rng.random() < 0.5 else rng.choice(pool))
        return words
    at = min(at, len(words) - 1)
    if kind == 1:
        del words[at]
    elif kind == 2:
        words.insert(at, words[at])
    elif kind == 3:
        other = rng.randrange(len(words))
        words[at], words[other] = words[other], words[at]
    elif kind == 4:
        words[at] = breaker(rng)
    elif kind == 5:
        words[at] = rng.choice(pool)
    else:
        words[at] = cut(rng, words[at])
    return words
