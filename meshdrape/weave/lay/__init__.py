"""From the start fibres to every node: the mould extended past its border, quadrants filled, nodes judged."""
