# A rez package of the unpacked archive. Untried: nobody has yet run it under rez.
# Put this file beside bin/ as package.py, in a folder of a packages path that is called fluidcarve/@VERSION@.
name = "fluidcarve"
version = "@VERSION@"
description = "Makes finished simulations narrower or wider, without simulating them again"
tools = ["fluidcarve"]


def commands():
    env.PATH.append("{root}/bin")
    env.MANPATH.append("{root}/share/man")
