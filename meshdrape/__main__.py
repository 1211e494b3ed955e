"""python -m meshdrape."""

import sys

from meshdrape.cli.main import main

sys.exit(main())
