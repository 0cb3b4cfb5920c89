"""What commands come to: each result with its numbers, lines, chapters and files."""
