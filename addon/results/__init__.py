"""What is made of a press: numbers, grade, certificate, comfort, reports and files."""
