"""The proof of the contact core: references, closed forms and invariants that share nothing with it."""
