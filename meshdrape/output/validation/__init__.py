"""The page of `meshdrape validate`: tables of claims and the pictures beside it."""

from meshdrape.output.validation.page import write_validation

__all__ = ["write_validation"]
