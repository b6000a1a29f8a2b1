"""What is written of a contact by vertex, where it ends on skin and product, and where a product is finer than skin."""
