"""The picture of a net, drawn without a screen."""
