"""The HTML report: chapters, pictures, tables, printed pages."""
