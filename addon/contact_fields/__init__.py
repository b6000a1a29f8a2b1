"""What is written of a contact: arrays by vertex, and where on skin and product the contact ends."""
