"""Figures, the HTML report and the PDF report."""
