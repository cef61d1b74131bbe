"""Answers for people: sentences and tables (…_words), pictures (…_pictures), pages.

page is one HTML file; sections, gap_report and fleet_page are what is put on it.
"""
