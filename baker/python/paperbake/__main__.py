"""python -m paperbake: the same as the command paperbake."""

from .program import main

main()
